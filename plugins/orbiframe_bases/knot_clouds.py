"""Knots at the vertices of a triangulation of X/H, in general position and the same for all lifts of a vertex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.triangulations import GeodesicTriangulation

Floats = NDArray[np.float64]

_GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))
# Knots move by no more than this share of the heights of the triangles there, so no triangle of knots turns over.
_SHARE_OF_HEIGHT = 0.4


def knot_clouds(domain: GeodesicTriangulation, count: int, radius: float, turn: float = 0.0) -> Floats:
    """A vertex and `count` points around it, for every vertex in the frame of its reference corner: (V, 1 + count, 3).

    The directions differ by the golden angle, the distances lie between 0.65 and 1 times r, which is `radius` times the
    shortest edge at the vertex, but at most 0.4 times the smallest height of a triangle there. So no three knots are in
    line, whatever the symmetries of the triangulation. turn: added to all directions, radians.
    """
    geometry, vertex = domain.geometry, domain.vertex.ravel()
    lengths = domain.edge_lengths.reshape(-1, 3)
    height = 2 * domain.areas / lengths.max(axis=1)
    shortest = np.minimum(lengths, np.roll(lengths, 1, axis=1)).ravel()
    size = np.full(domain.vertex_count, np.inf)
    np.minimum.at(size, vertex, np.minimum(radius * shortest, _SHARE_OF_HEIGHT * np.repeat(height, 3)))
    home = domain.corners.reshape(-1, 3)[domain.vertex_corner]
    number = np.arange(1, count + 1)
    angle = turn + _GOLDEN_ANGLE * (number + (count + 1) * np.arange(domain.vertex_count)[:, None])
    distance = size[:, None] * (1 - 0.35 * np.mod(number * 0.7548776662466927, 1))
    step = distance[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    frame = geometry.frame(home)
    around = geometry.exp(home[:, None], np.einsum("vij,vkj->vki", frame, step))
    return np.concatenate([home[:, None], around], axis=1)


def flatness(knots: Floats, triples: NDArray[np.intp]) -> float:
    """How near to a line three knots come, over sets of knots (E, K, 3) and triples (t, 3): the smallest sine of the
    angle between the longest and the shortest side of their triangle."""
    p, q, r = np.moveaxis(knots[:, triples], 2, 0)
    sides = np.sort([np.linalg.norm(a - b, axis=-1) for a, b in ((p, q), (q, r), (r, p))], axis=0)
    volume = np.abs(np.einsum("eti,eti->et", np.cross(p, q - p), r - p))
    with np.errstate(all="ignore"):
        return float(np.nan_to_num(volume / (sides[0] * sides[2])).min())
