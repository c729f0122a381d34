"""Crowding: how unevenly a map spreads the mesh over X/H, and how many digits that costs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.triangulations.triangulation import Triangulation


class Crowding(NamedTuple):
    """area_ratio: the area in X of the smallest triangle over that of the largest; digits_lost: decimal digits."""

    area_ratio: float
    digits_lost: float


def crowding_of(triangulation: Triangulation) -> Crowding:
    """How unevenly the triangles of a map share X/H, and the digits that the smallest of them have lost.

    A finger of length L and radius r is mapped to a disc that is smaller than its root by about exp(-L/r), with any
    map that hardly distorts angles. Coordinates have 16 digits; of these a triangle loses the first ones, those in
    which its corners agree: the logarithm of the distance from the origin of the patch over the shortest edge. The
    largest loss of all triangles counts.
    """
    areas = np.abs(triangulation.areas)
    distances, edges = _distances(triangulation), _shortest_edges(triangulation)
    most = np.divide(distances, edges, out=np.full_like(edges, np.inf), where=edges > 0).max()
    return Crowding(float(areas.min() / areas.max()), float(np.log10(max(most, 1.0))))


def _distances(triangulation: Triangulation) -> NDArray[np.float64]:
    """How large the coordinates of the corners of every triangle are that are not near to 1 anyway, (F,)."""
    far = np.linalg.norm(triangulation.lifts[..., 1:], axis=-1)
    # On the far half of S^2 no small number is near to the origin.
    return np.asarray(np.where(triangulation.lifts[..., 0] < 0, 1.0, far).max(axis=1))


def _shortest_edges(triangulation: Triangulation) -> NDArray[np.float64]:
    corners = triangulation.lifts
    return np.asarray(triangulation.orbifold.geometry.distance(corners, np.roll(corners, -1, axis=1)).min(axis=1))
