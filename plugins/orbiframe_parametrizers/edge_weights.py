"""Edge weights of a triangle mesh in space: cotangents, mean values, ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron

Floats = NDArray[np.float64]


def cotangent(mesh: Polyhedron) -> Floats:
    """Half the sum of the cotangents of the two angles opposite to an edge, on every halfedge (H,).

    The stiffness matrix of linear elements, so that the harmonic map follows the metric of the mesh; negative where
    the two angles add up to more than pi.
    """
    before, after = _corner_edges(mesh)
    dot = np.einsum("hi,hi->h", before, after)
    area = np.linalg.norm(np.cross(before, after), axis=1)
    with np.errstate(all="ignore"):
        half = 0.5 * dot / area
    opposite = mesh.next[mesh.next]
    return np.asarray(half[opposite] + half[opposite[mesh.twin]])


def mean_value(mesh: Polyhedron) -> Floats:
    """Tangents of half the four angles beside an edge over its length, on every halfedge (H,); always positive.

    Floater's mean value coordinates (2003), averaged over the two ends to be symmetric.
    """
    after, before = _corner_edges(mesh)
    cross = np.linalg.norm(np.cross(after, before), axis=1)
    dot = np.einsum("hi,hi->h", after, before)
    product = np.linalg.norm(after, axis=1) * np.linalg.norm(before, axis=1)
    with np.errstate(all="ignore"):
        half_tangent = np.where(dot > 0, cross / (product + dot), (product - dot) / cross)
        side = (half_tangent + half_tangent[mesh.next]) / (2 * mesh.edge_lengths)
    return np.asarray(side + side[mesh.twin])


def uniform(mesh: Polyhedron) -> Floats:
    """One on every halfedge (H,): the map sees the connectivity alone."""
    return np.ones(len(mesh.tail))


def _corner_edges(mesh: Polyhedron) -> tuple[Floats, Floats]:
    """At every corner the edge vectors to the next and to the previous corner of its triangle, (H, 3) each."""
    after = mesh.vertices[mesh.head] - mesh.vertices[mesh.tail]
    return after, -after[mesh.next[mesh.next]]


WEIGHTS: dict[str, Callable[[Polyhedron], Floats]] = {
    "cotangent": cotangent,
    "mean-value": mean_value,
    "uniform": uniform,
}
