"""Groups of orbifolds with cone points and mirrors, and what such a group does to a point."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.groups.group import Group
from orbiframe.groups.mirrored_polygon import MirroredPolygon, orbifold_polygon
from orbiframe.groups.polygon_group import PolygonGroup
from orbiframe.groups.spherical_group import SphericalGroup
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.planes.geometry import Geometry
from orbiframe.words.conway_symbol import ConwaySymbol
from orbiframe.words.mirror_word import Relations

Floats = NDArray[np.float64]


class ConwayGroup(PolygonGroup):
    """The group of a polygon with glued sides and mirrors that meets Poincare's conditions.

    Points of X may be fixed by elements of the group, but none in the inside of the polygon: `tiles` and `reduce` are
    those of a group that acts freely. Raises GeometryError where the conditions fail.
    """

    polygon: MirroredPolygon

    def __init__(self, polygon: MirroredPolygon) -> None:
        super().__init__(polygon)
        self.signature = polygon.signature

    @property
    def relations(self) -> Relations:
        """The presentation by the letters of the word, from the angles of the polygon (Poincare's theorem)."""
        return Relations.of(self.polygon.word, self.polygon.orders)


def orbifold_group(geometry: Geometry, signature: ConwaySymbol) -> ConwayGroup | SphericalGroup:
    """The group of an orbifold in its geometry: a group of a polygon, or on the sphere a finite list.

    Of the many shapes of a hyperbolic or Euclidean orbifold other than a triangle group this is one with as much
    symmetry as its symbol allows, see `orbifold_polygon`. Raises GeometryError if the geometry has another curvature
    than the orbifold.
    """
    if signature.curvature > 0:
        return SphericalGroup(geometry, signature)
    return ConwayGroup(orbifold_polygon(geometry, signature))


def stabilizer(group: Group, x: ArrayLike, tolerance: float = 1e-7) -> Floats:
    """The elements of a group that fix a point x (3,) of X, (k, 3, 3), the identity first.

    They are those of y = g x in the polygon, which lies in the tile of each, carried back by g: k is the order n of a
    cone point, 2 on a mirror, 2 m in a corner, else 1. tolerance: how near a fixed point counts as x itself.
    """
    geometry = group.geometry
    y, g = group.reduce(x)
    near = group.tiles(float(geometry.distance(geometry.origin, y)) + tolerance)
    fixing = near[geometry.distance(geometry.act(near, y), y) <= tolerance]
    return np.asarray(geometry.inverse(g) @ fixing @ g)


def orbifold_of(group: ConwayGroup | SphericalGroup) -> Orbifold:
    """X/H with the polygon as its one patch, for functions on it."""
    signature = group.signature
    return Orbifold(group.atlas(), signature.euler_characteristic, signature.orientable, group.area)
