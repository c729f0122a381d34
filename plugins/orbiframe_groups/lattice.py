"""Groups of the Euclidean plane with a parallelogram as polygon."""

from __future__ import annotations

import numpy as np

from orbiframe import FundamentalPolygon, Geometry, GeometryError, Group, Word
from orbiframe.groups import PolygonGroup


def lattice_group(
    geometry: Geometry,
    word: Word,
    *,
    first: tuple[float, float] = (1.0, 0.0),
    second: tuple[float, float] = (0.0, 1.0),
) -> Group:
    """The group of a parallelogram, centred at the origin, whose four sides a word glues.

    first, second: the vectors of the sides 0 and 1, in this order counterclockwise. `abAB` is the torus of the lattice
    that they span; `abaB` a Klein bottle, with a glide reflection from side 2 to side 0; `aabb` a Klein bottle if the
    two lengths agree. Raises GeometryError for another geometry or word, dependent or clockwise vectors, or glued sides
    of different lengths.
    """
    if geometry.curvature or len(word) != 4 or word.euler_characteristic:
        raise GeometryError(
            f"'{word}' is a {word.surface} with {len(word)} sides, wanted in {geometry.name}; a lattice takes a word "
            "with four sides for a torus or Klein bottle, such as abAB, abaB or aabb, in e2"
        )
    a, b = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    area = a[0] * b[1] - a[1] * b[0]
    if not area > 1e-12 * np.hypot(*a) * np.hypot(*b):
        raise GeometryError(
            f"the vectors {tuple(first)} and {tuple(second)} span the signed area {area:.6g}; give two independent "
            "vectors, the second counterclockwise from the first"
        )
    corners = np.array([-a - b, a - b, a + b, b - a]) / 2
    return PolygonGroup(FundamentalPolygon(geometry, geometry.from_chart("projective", corners), word))
