"""Delaunay triangulations of X/H by an outside program: scipy on many lifts of the sites."""

from __future__ import annotations

import numpy as np
from orbiframe_geometries.e2 import E2
from orbiframe_geometries.h2 import H2
from orbiframe_geometries.s2 import S2
from orbiframe_groups.regular_polygon import regular_polygon_group
from scipy.spatial import ConvexHull, Delaunay

from orbiframe.groups.group import Group
from orbiframe.orbifolds.atlas import Points
from orbiframe.words.word import Word

WORDS = ("aA", "aa", "abAB", "aabb", "abaB", "abcdABCD", "abABcdCD", "aabbcc", "aabbccdd")


def group_of(text: str) -> Group:
    """The group of the regular cell of a word."""
    word = Word.parse(text)
    geometry = {1: S2, 0: E2, -1: H2}[int(np.sign(word.euler_characteristic))]()
    return regular_polygon_group(geometry, word)


def random_sites(group: Group, count: int, seed: int) -> Points:
    """Random points within the circle inscribed in the cell; on the sphere anywhere."""
    rng = np.random.default_rng(seed)
    if group.geometry.curvature > 0:
        x = group.geometry.project(rng.normal(size=(count, 3)))
    else:
        radius = 0.98 * group.polygon.inradius * np.sqrt(rng.random(count))
        x = group.geometry.from_polar(radius, rng.uniform(0, 2 * np.pi, count))
    return Points(np.zeros(count, dtype=np.intp), x)


def delaunay_areas(group: Group, sites: Points) -> np.ndarray:
    """The sorted areas of the Delaunay triangles of X/H."""
    return _on_sphere(group, sites.x) if group.geometry.curvature > 0 else _in_plane(group, sites.x)


def _on_sphere(group: Group, x: np.ndarray) -> np.ndarray:
    elements = group.tiles(np.pi)
    lifts = (elements[:, None] @ x[None, :, :, None])[..., 0].reshape(-1, 3)
    corners = lifts[ConvexHull(lifts).simplices]
    areas = np.sort(np.abs(group.geometry.triangle_area(*np.moveaxis(corners, 1, 0))))
    return areas[:: len(elements)]


def _in_plane(group: Group, x: np.ndarray) -> np.ndarray:
    geometry, cell = group.geometry, group.polygon.circumradius
    reach = cell + 2 * min(cell, 4 * np.sqrt(group.area / len(x))) + 0.1
    lifts = (group.tiles(reach)[:, None] @ x[None, :, :, None])[..., 0].reshape(-1, 3)
    lifts = lifts[geometry.distance(geometry.origin, lifts) <= reach]
    # In the conformal model circles are circles: hyperbolic and Euclidean Delaunay triangles are the same.
    corners = lifts[Delaunay(geometry.to_chart("conformal", lifts)).simplices]
    centre = corners.sum(axis=1)
    inside = (centre @ group.polygon.sides.T > 0).all(axis=1)
    return np.sort(np.abs(geometry.triangle_area(*np.moveaxis(corners[inside], 1, 0))))
