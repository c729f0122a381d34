"""Matrices, 3 by 3, for compiled code: entry by entry, which is quicker and compiled sooner than slices."""

from __future__ import annotations

from orbiframe.compiled.decorator import compiled


@compiled(arrays=False)
def multiply(a, b, out):  # type: ignore[no-untyped-def]
    """out = a b; out is another array than a and b."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@compiled(arrays=False)
def copy(a, out):  # type: ignore[no-untyped-def]
    """out = a."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, j]


@compiled(arrays=False)
def exchange(a, b):  # type: ignore[no-untyped-def]
    """Each gets the entries of the other."""
    for i in range(3):
        for j in range(3):
            a[i, j], b[i, j] = b[i, j], a[i, j]


@compiled(arrays=False)
def set_identity(g):  # type: ignore[no-untyped-def]
    """g = 1."""
    for i in range(3):
        for j in range(3):
            g[i, j] = 1.0 if i == j else 0.0


@compiled(arrays=False)
def is_identity(g):  # type: ignore[no-untyped-def]
    """Whether g is the identity, to the bit."""
    for i in range(3):
        for j in range(3):
            if g[i, j] != (1.0 if i == j else 0.0):
                return False
    return True
