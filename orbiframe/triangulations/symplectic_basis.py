"""Symplectic bases: integral combinations that bring a unimodular skew form to its standard shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import TopologyError

Ints = NDArray[np.intp]


def standard_form(genus: int) -> Ints:
    """The skew form (0, 1; -1, 0) in blocks of so many rows, (2 g, 2 g)."""
    zero, one = np.zeros((genus, genus), dtype=np.intp), np.eye(genus, dtype=np.intp)
    return np.block([[zero, one], [-one, zero]])


def symplectic_basis(form: Ints) -> Ints:
    """Integers T (2 g, 2 g) with T form T^T the standard form; its rows are the combinations.

    form: skew, with integers, of determinant 1. By Euclid's algorithm on rows. Raises TopologyError for another form.
    """
    size = len(form)
    rest, chosen = [np.eye(size, dtype=np.intp)[k] for k in range(size)], []
    while len(rest) > 1:
        e, rest = rest[0], rest[1:]
        f, rest = _partner(form, e, rest)
        rest = [v - int(v @ form @ f) * e + int(v @ form @ e) * f for v in rest]
        chosen.append((e, f))
    found = np.array([*(e for e, _ in chosen), *(f for _, f in chosen)], dtype=np.intp).reshape(-1, size)
    if size % 2 or (found @ form @ found.T != standard_form(size // 2)).any():
        raise TopologyError("the form is not skew of determinant 1 in integers, so that it has no symplectic basis")
    return found


def _partner(form: Ints, e: Ints, rest: list[Ints]) -> tuple[Ints, list[Ints]]:
    """A combination f with e form f = 1, and others that complete it."""
    rest = list(rest)
    while True:
        product = np.array([int(e @ form @ v) for v in rest])
        others = np.flatnonzero(product)
        if not len(others):
            raise TopologyError("the form is degenerate, so that it has no symplectic basis")
        least = others[np.abs(product[others]).argmin()]
        if len(others) == 1:
            f = rest.pop(least)
            return f * np.sign(product[least]), rest
        for k in others:
            if k != least:
                rest[k] = rest[k] - product[k] // product[least] * rest[least]
