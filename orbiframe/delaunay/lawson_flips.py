"""Lawson flips to the Delaunay triangulation of X/H, one empty-circle test for the three geometries.

One edge of X/H stands for its whole orbit, so what is done to it is done to all of them at once: where four sites lie
on one circle, the diagonal that is there stays, and the choice is invariant under H. That the flips of a geometric
triangulation of a closed surface end at a Delaunay triangulation: Despre, Schlenker, Teillaud, Flipping geometric
triangulations on hyperbolic surfaces (2020).
"""

from __future__ import annotations

from orbiframe.compiled.decorator import compiled
from orbiframe.delaunay.triangle_arrays import after, before, corner, flip, move

# A site must lie this far inside a circle, relative to the terms of the test, to count: rounding must not decide.
TOLERANCE = 1e-10


@compiled(arrays=False)
def chord(curvature, x, y):  # type: ignore[no-untyped-def]
    """y - x, with y0 - x0 from the differences of (x1, x2) where these determine x0."""
    u, v = y[1] - x[1], y[2] - x[2]
    if curvature > 0:
        return y[0] - x[0], u, v
    return -curvature * (u * (x[1] + y[1]) + v * (x[2] + y[2])) / (x[0] + y[0]), u, v


@compiled(arrays=False)
def versine(curvature, d):  # type: ignore[no-untyped-def]
    """1 - cos, half the square or cosh - 1 of the distance of two points near the origin, from their chord d."""
    return (d[1] * d[1] + d[2] * d[2] + curvature * d[0] * d[0]) / 2


@compiled(arrays=False)
def volume(x, u, v):  # type: ignore[no-untyped-def]
    """det(x, u, v); positive for chords u, v from x to the other corners of a counterclockwise triangle."""
    return x[0] * (u[1] * v[2] - u[2] * v[1]) + x[1] * (u[2] * v[0] - u[0] * v[2]) + x[2] * (u[0] * v[1] - u[1] * v[0])


@compiled(arrays=False)
def turn(curvature, x, y, z):  # type: ignore[no-untyped-def]
    """det(x, y, z), positive for a counterclockwise triangle, without cancellation."""
    return volume(x, chord(curvature, x, y), chord(curvature, x, z))


@compiled(arrays=False)
def outside(curvature, a, b, c, d):  # type: ignore[no-untyped-def]
    """How far d lies outside the circle through a, b, c (counterclockwise), and the size of the terms.

    The signed volume of the four points lifted to the sphere, paraboloid or hyperboloid: with versines from a, which
    are the heights there, c_b [a, c, d] + c_c [a, d, b] + c_d [a, b, c].
    """
    p, q, r = chord(curvature, a, b), chord(curvature, a, c), chord(curvature, a, d)
    first = versine(curvature, p) * volume(a, q, r)
    second = versine(curvature, q) * volume(a, r, p)
    third = versine(curvature, r) * volume(a, p, q)
    return first + second + third, abs(first) + abs(second) + abs(third)


@compiled(arrays=False)
def wants_flip(triangles, e):  # type: ignore[no-untyped-def]
    """Whether the apex across an edge lies inside the circle of its triangle, in a strictly convex quadrilateral."""
    t = triangles.twin[e]
    if t // 3 == e // 3:
        return False
    k = triangles.curvature
    a, b, c = corner(triangles, e), corner(triangles, after(e)), corner(triangles, before(e))
    d = move(k, triangles.gluing[e], corner(triangles, before(t)))
    height, size = outside(k, a, b, c, d)
    return height < -TOLERANCE * size and turn(k, c, d, b) > 0 and turn(k, d, c, a) > 0


@compiled(arrays=False)
def push(triangles, top, e):  # type: ignore[no-untyped-def]
    """Put an edge on the stack, unless it waits there already; returns the new height of the stack."""
    if triangles.queued[e]:
        return top
    triangles.queued[e] = True
    triangles.stack[top] = e
    return top + 1


@compiled(arrays=False)
def push_all(triangles, count):  # type: ignore[no-untyped-def]
    """Put every edge of the first `count` triangles on the empty stack; returns its height."""
    top = 0
    for e in range(3 * count - 1, -1, -1):
        if e < triangles.twin[e]:
            top = push(triangles, top, e)
    return top


@compiled(arrays=False)
def push_around(triangles, top, e):  # type: ignore[no-untyped-def]
    """Put the four outer edges of a quadrilateral on the stack, after its diagonal e has been flipped."""
    f, g = 3 * (e // 3), 3 * (triangles.twin[3 * (e // 3)] // 3)
    return push(triangles, push(triangles, push(triangles, push(triangles, top, f + 1), f + 2), g + 1), g + 2)


@compiled(arrays=False)
def legalise(triangles, top, most):  # type: ignore[no-untyped-def]
    """Flip the edges on the stack, and those about them, until none wants it; False after `most` flips."""
    while top > 0:
        top -= 1
        e = triangles.stack[top]
        triangles.queued[e] = False
        if triangles.twin[e] < 0 or not wants_flip(triangles, e):
            continue
        if most <= 0:
            return False
        most -= 1
        flip(triangles, e)
        top = push_around(triangles, top, e)
    return True


@compiled(arrays=False)
def legalise_star(triangles, top):  # type: ignore[no-untyped-def]
    """The same for the edges opposite a new vertex of Delaunay triangles: its own edges never want to flip."""
    while top > 0:
        top -= 1
        e = triangles.stack[top]
        triangles.queued[e] = False
        if wants_flip(triangles, e):
            f, g = e // 3, triangles.twin[e] // 3
            flip(triangles, e)
            top = push(triangles, push(triangles, top, 3 * f + 1), 3 * g + 2)
