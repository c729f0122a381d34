"""Groups of the Euclidean plane whose polygon is a rhombus."""

from __future__ import annotations

import numpy as np

from orbiframe import FundamentalPolygon, Geometry, GeometryError, Group, Word
from orbiframe.groups import PolygonGroup


def rhombus(geometry: Geometry, word: Word, *, angle: float = 60.0) -> Group:
    """The group of a rhombus of side 1 about the origin, whose four sides a word glues.

    angle: at its first corner, in degrees, between 0 and 180; 60 is the lattice of the hexagons. Raises GeometryError
    for another geometry or word.
    """
    if geometry.curvature or len(word) != 4 or word.euler_characteristic:
        raise GeometryError(f"'{word}' in {geometry.name}: a rhombus takes a word of four sides in the Euclidean plane")
    if not 0 < angle < 180:
        raise GeometryError(f"a rhombus with an angle of {angle:g} degrees; give one between 0 and 180")
    first, second = 1.0, np.exp(1j * np.radians(angle))
    corners = np.array([-first - second, first - second, first + second, second - first]) / 2
    points = geometry.from_chart("projective", np.stack([corners.real, corners.imag], axis=1))
    return PolygonGroup(FundamentalPolygon(geometry, points, word))
