"""Flips of edges in space: for larger least angles, and for six edges at every vertex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe_remeshing.edges import Edges, edges_of
from orbiframe_remeshing.surface_mesh import cross, least_angles

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Degrees by which a least angle must grow: rounding must not decide.
_GAIN = 1e-7
# A flip for the valences may leave a least angle of so many degrees, or the one that was there.
_ENOUGH = 25.0
_REGULAR = 6


def flipped_for_angles(places: Floats, triangles: Ints, kept: Ints | None = None) -> Ints:
    """Triangles (F, 3) of which no flip makes the least angle of the two larger; kept: (n, 2), edges that stay.

    No flip makes an edge that is there already, or turns a triangle against the two that it replaces; each makes the
    sorted list of all least angles larger, so they end. In the plane what is left is a Delaunay triangulation
    (Sibson 1978).
    """
    while True:
        edges = edges_of(triangles, len(places))
        before, after, allowed = _angles(places, edges, kept)
        gain = np.where(allowed, after - before, 0.0)
        chosen = _apart(gain, _GAIN, (edges.first, edges.second), len(triangles))
        if not len(chosen):
            return triangles
        triangles = _flipped(triangles, edges, chosen)


def flipped_for_valences(
    places: Floats, triangles: Ints, kept: Ints | None = None, regular: Ints | int = _REGULAR
) -> Ints:
    """Triangles (F, 3) of which no flip brings the numbers of them at four vertices nearer to six; kept: as above.

    regular: other numbers than six, (V,). The sum of squares is what falls. No flip makes a least angle below
    25 degrees smaller.
    """
    while True:
        edges = edges_of(triangles, len(places))
        before, after, allowed = _angles(places, edges, kept)
        excess = np.bincount(triangles.ravel(), minlength=len(places)) - regular
        fall = excess[edges.a] + excess[edges.b] - excess[edges.c] - excess[edges.d] - 2
        gain = np.where(allowed & (after > np.minimum(before, _ENOUGH)), fall, 0).astype(np.float64)
        chosen = _apart(gain, 0.0, (edges.a, edges.b, edges.c, edges.d), len(places))
        if not len(chosen):
            return triangles
        triangles = _flipped(triangles, edges, chosen)


def _angles(places: Floats, edges: Edges, kept: Ints | None) -> tuple[Floats, Floats, Bools]:
    """The least angle of both triangles at every edge, that after a flip, and whether the flip is allowed."""
    old = [np.stack(corners, axis=1) for corners in ((edges.a, edges.b, edges.c), (edges.a, edges.d, edges.b))]
    new = [np.stack(corners, axis=1) for corners in ((edges.a, edges.d, edges.c), (edges.d, edges.b, edges.c))]
    before, after = (np.minimum(*(least_angles(places, t) for t in pair)) for pair in (old, new))
    normal = cross(places, old[0]) + cross(places, old[1])
    upright = [np.einsum("ei,ei->e", cross(places, t), normal) > 0 for t in new]
    return before, after, upright[0] & upright[1] & ~edges.joined() & ~edges.among(kept)


def _apart(gain: Floats, least: float, claims: tuple[Ints, ...], count: int) -> Ints:
    """Edges that gain more than `least`, of which no two claim the same thing (of `count`); the best come first."""
    wanted = np.flatnonzero(gain > least)
    wanted = wanted[np.argsort(-gain[wanted], kind="stable")]
    rank = np.arange(len(wanted))
    first = np.full(count, len(wanted))
    for claim in claims:
        np.minimum.at(first, claim[wanted], rank)
    return np.asarray(wanted[np.all([first[claim[wanted]] == rank for claim in claims], axis=0)])


def _flipped(triangles: Ints, edges: Edges, chosen: Ints) -> Ints:
    """The triangles with some edges flipped; of edges that would be the same one only the first."""
    chosen = chosen[np.sort(np.unique(edges.other_key[chosen], return_index=True)[1])]
    made = triangles.copy()
    a, b, c, d = (getattr(edges, name)[chosen] for name in "abcd")
    made[edges.first[chosen]] = np.stack([a, d, c], axis=1)
    made[edges.second[chosen]] = np.stack([d, b, c], axis=1)
    return made
