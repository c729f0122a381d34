"""Claims of speed about maps and groups."""

from __future__ import annotations

import map as maps
import numpy as np
from claim import Action, Claim
from orbiframe_geometries.h2 import H2
from orbiframe_invariants.word_growth import elements_by_length
from orbiframe_markers.tree_cotree import tree_cotree
from orbiframe_parametrizers.circle_packing import packed
from orbiframe_parametrizers.developing import developed
from orbiframe_parametrizers.elimination import Elimination, elimination_order, factorised
from orbiframe_parametrizers.embedding import embedded
from orbiframe_parametrizers.harmonic import harmonic
from scipy.sparse.linalg import splu

from orbiframe import Word
from orbiframe.groups import PolygonGroup, elements_within, regular_polygon
from orbiframe.meshes.surface_type import surface_type

_MAP, _GROUPS = "[speed of the map](map_speed.md)", "[groups](../how_to/hyperbolic_groups.md)"


def factors() -> tuple[Action, Action]:
    """The order and the factors of a matrix on the edges of a mesh, and scipy's splu as it comes."""
    large = maps.plate(2, 100_000)
    tail, head = large.tail[large.representative], large.head[large.representative]
    degree = np.bincount(tail, minlength=len(large.vertices)) + np.bincount(head, minlength=len(large.vertices))
    entries, diagonal = -np.ones(len(tail)), degree + 0.01
    plain = Elimination(np.arange(len(degree)), np.arange(len(degree))).matrix(tail, head, entries, diagonal)

    def ours() -> object:
        order = elimination_order(len(degree), tail, head)
        return factorised(Elimination(order, np.argsort(order)).matrix(tail, head, entries, diagonal))

    return ours, lambda: splu(plain)


def map_to_disc() -> tuple[Action, Action]:
    """The harmonic map to X/H of a metric that is known, and libigl's of the disc that is left when the mesh is cut."""
    mesh = maps.plate(2, 100_000)
    packing = packed(mesh, -1)
    lengths, angles = packing.lengths, packing.angles
    layout = developed(mesh, H2(), lengths, angles, surface=surface_type(mesh), patch_radius=1.0)
    disc = maps.cut_open(mesh, tree_cotree(mesh))
    return lambda: embedded(layout, "auto"), lambda: maps.disc_map(*disc)


def whole_map() -> tuple[Action, Action]:
    """The whole map with its metric, and libigl's of the disc."""
    mesh = maps.plate(2, 100_000)
    disc = maps.cut_open(mesh, tree_cotree(mesh))
    return lambda: harmonic(maps.fresh(mesh), H2()), lambda: maps.disc_map(*disc)


def by_length() -> tuple[Action, Action]:
    """Elements of the group of the octagon with their words, and as many cells by hypertiling."""
    group = PolygonGroup(regular_polygon(H2(), Word.parse("abcdABCD")))
    return lambda: elements_by_length(group, 7), _cells


def by_radius() -> tuple[Action, Action]:
    """Elements of the group of the octagon within a radius, and about as many cells by hypertiling."""
    group = PolygonGroup(regular_polygon(H2(), Word.parse("abcdABCD")))
    return lambda: elements_within(group, 1.95 * 7 + 1.3), _cells


def _cells() -> object:
    from hypertiling import HyperbolicTiling

    return HyperbolicTiling(8, 8, 8, kernel="GRC")


CLAIMS = (
    Claim("order and factors of one matrix, 101,248 vertices", "`scipy.sparse.linalg.splu`", 1.3, _MAP, factors),
    Claim("harmonic map to X/H, 101,248 vertices", "libigl's of a disc", 1 / 12, _MAP, map_to_disc),
    Claim("whole map, 101,248 vertices", "libigl's of a disc", 1 / 18, _MAP, whole_map),
    Claim("elements by length", "hypertiling's cells, without words", 2.0, _GROUPS, by_length),
    Claim("elements by radius", "hypertiling's cells, without words", 1.0, _GROUPS, by_radius),
)
