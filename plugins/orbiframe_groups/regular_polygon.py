"""Groups of regular polygons."""

from __future__ import annotations

from orbiframe import Geometry, Group, Word
from orbiframe.groups import PolygonGroup, regular_polygon
from orbiframe_groups.finite import FiniteGroup


def regular_polygon_group(geometry: Geometry, word: Word) -> Group:
    """The group of the regular polygon whose sides a word glues (section 2.5).

    In H^2 and E^2 the group of side pairings of `regular_polygon`; on S^2 the special polygons of the sphere and the
    projective plane, see `FiniteGroup`. Raises GeometryError if the surface has another geometry, or vertices with
    different numbers of corners.
    """
    if geometry.curvature > 0:
        return FiniteGroup(geometry, word)
    return PolygonGroup(regular_polygon(geometry, word))
