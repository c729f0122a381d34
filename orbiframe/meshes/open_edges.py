"""Seams: where open edges of a polyhedron lie upon one another, as if the faces were meant to meet there."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from orbiframe.errors import TopologyError
from orbiframe.meshes.coincident_points import clusters, first_of_each, unit_scale
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Vertices on a seam are nearer than this to each other, relative to the open edges that they end.
_NEAR = 0.05
# A vertex lies in an edge if it is nearer to it than this, relative to its length.
_ON_EDGE = 1e-6
_CHUNK, _BUDGET = 1000, 2_000_000


@dataclass(frozen=True, slots=True)
class Seams:
    """What the open edges of a polyhedron say about the joints that are missing.

    vertices: (n,) ends of open edges that coincide, or nearly so, with others; tolerance: the least round one for a
    weld that joins them, 0 where they coincide exactly; closed: how many open edges that weld closes; junctions:
    (m, 3) a vertex, and the ends of an open edge that it lies inside of (looked for after that weld); complete:
    whether all open edges were looked at for junctions.
    """

    vertices: Ints
    tolerance: float
    closed: int
    junctions: Ints
    complete: bool = True


def open_halfedges(polyhedron: Polyhedron) -> Ints:
    """The halfedges whose edge lies in no other face, in the order of the faces; loops at a vertex do not count."""
    alone = np.flatnonzero((polyhedron.twin < 0) & (polyhedron.tail != polyhedron.head))
    ends = np.stack([polyhedron.tail[alone], polyhedron.head[alone]], axis=1)
    return alone[_single(ends)]


def seams(polyhedron: Polyhedron) -> Seams:
    """The seams and T-junctions of a polyhedron. Linear in the open edges, up to sorting and nearest points."""
    halfedges = open_halfedges(polyhedron)
    ends = np.stack([polyhedron.tail[halfedges], polyhedron.head[halfedges]], axis=1)
    vertex, local = np.unique(ends, return_inverse=True)
    points, unit = unit_scale(polyhedron.vertices[vertex], 1.0)
    if not len(vertex) or not np.isfinite(points).all():
        return Seams(vertex[:0], 0.0, 0, np.empty((0, 3), dtype=np.intp))
    local = local.reshape(-1, 2)
    label, tolerance = _seam_labels(points, local)
    left = _still_open(label[local])
    first = first_of_each(label)
    junctions, complete = _junctions(points[first], label[local][left], tolerance)
    together = np.bincount(label)[label] > 1
    on_seam = np.zeros(len(vertex), dtype=np.bool_)
    on_seam[np.delete(local, left, axis=0)] = True
    named = vertex[first][junctions]
    return Seams(vertex[on_seam & together], _round_up(tolerance / unit), len(local) - len(left), named, complete)


def _seam_labels(points: Floats, ends: Ints) -> tuple[Ints, float]:
    """The clusters that a weld would make of the points, and its tolerance: equal points first, then near ones."""
    label = clusters(points)
    first = first_of_each(label)
    left = label[ends][_still_open(label[ends])]
    gap = _gap(points[first], left)
    if gap == 0:
        return label, 0.0
    tolerance = 2 * gap
    try:
        near = clusters(points, tolerance)
    except TopologyError:
        return label, 0.0
    # What folds an edge up is no joint: the vertices are near each other for another reason.
    folds = (near[ends[:, 0]] == near[ends[:, 1]]) & (label[ends[:, 0]] != label[ends[:, 1]])
    return (label, 0.0) if folds.any() else (near, tolerance)


def _gap(points: Floats, ends: Ints) -> float:
    """The largest distance between ends of open edges that are near to each other, 0 where none are."""
    if not len(ends):
        return 0.0
    vertex, local = np.unique(ends, return_inverse=True)
    local = local.reshape(-1, 2)
    length = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1)
    shortest = np.full(len(vertex), np.inf)
    np.minimum.at(shortest, local.ravel(), np.repeat(length, 2))
    distance, other = (np.asarray(table)[:, 0] for table in cKDTree(points[vertex]).query(points[vertex], k=[2]))
    near = distance <= _NEAR * np.minimum(shortest, shortest[other])
    return float(distance[near].max(initial=0.0))


def _junctions(points: Floats, ends: Ints, tolerance: float) -> tuple[Ints, bool]:
    """Ends of open edges inside of other open edges: (m, 3) of a point and two ends; and whether all were looked at."""
    vertex = np.flatnonzero(np.bincount(ends.ravel()))
    tree = cKDTree(points[vertex]) if len(vertex) else None
    length = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1)
    # Short edges first: long ones among many points are what may cost too much.
    order = np.argsort(length, kind="stable")
    found, spent = [np.empty((0, 3), dtype=np.intp)], 0
    for start in range(0, len(ends), _CHUNK):
        edges = order[start : start + _CHUNK]
        middle, radius = points[ends[edges]].mean(axis=1), length[edges] / 2
        assert tree is not None
        counts = tree.query_ball_point(middle, radius, return_length=True)
        spent += int(counts.sum())
        if spent > _BUDGET:
            return np.concatenate(found), False
        inside = np.concatenate(tree.query_ball_point(middle, radius)).astype(np.intp)
        candidates = np.column_stack([vertex[inside], np.repeat(ends[edges], counts, axis=0)])
        found.append(candidates[_inside(points[candidates], tolerance)])
    joined = np.concatenate(found)
    return joined[np.lexsort(joined.T[::-1])], True


def _inside(points: Floats, tolerance: float) -> NDArray[np.bool_]:
    """Whether the first of three points (n, 3, 3) lies between the two others, and not at them."""
    point, start, end = points[:, 0], points[:, 1], points[:, 2]
    along = end - start
    length = np.linalg.norm(along, axis=1)
    reach = np.maximum(_ON_EDGE * length, tolerance)
    place = np.einsum("ni,ni->n", point - start, along) / np.maximum(length, np.finfo(np.float64).tiny)
    off = np.linalg.norm(
        point - start - along * (place / np.maximum(length, np.finfo(np.float64).tiny))[:, None], axis=1
    )
    return np.asarray((off <= reach) & (place > reach) & (place < length - reach))


def _single(ends: Ints) -> NDArray[np.bool_]:
    """Whether an edge (n, 2) has ends that no other edge of the list has."""
    if not len(ends):
        return np.empty(0, dtype=np.bool_)
    low, high = ends.min(axis=1), ends.max(axis=1)
    _, inverse, count = np.unique(low * (high.max() + 1) + high, return_inverse=True, return_counts=True)
    return np.asarray(count[inverse.ravel()] == 1)


def _still_open(ends: Ints) -> Ints:
    """The edges (n, 2) that stay open once those with the same ends are joined in pairs; loops vanish."""
    return np.flatnonzero(_single(ends) & (ends[:, 0] != ends[:, 1]))


def _round_up(length: float) -> float:
    """The length rounded up to one digit."""
    if length <= 0 or not math.isfinite(length):
        return length
    digit = 10.0 ** math.floor(math.log10(length))
    return float(f"{math.ceil(length / digit) * digit:.0e}") if digit > 0 else length
