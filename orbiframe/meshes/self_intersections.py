"""Self-intersections: which triangles of a mesh pass through others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from orbiframe.compiled.decorator import compiled
from orbiframe.meshes.polyhedron import Polyhedron

Ints = NDArray[np.intp]

_SIZES = 1.5  # triangles whose radii differ by less than this factor are searched together


def self_intersecting(mesh: Polyhedron) -> Ints:
    """The triangles, in order, that meet another one beyond a common vertex or edge.

    Two triangles that share an edge are not tried, and of two that share a vertex only the sides opposite to it, so
    that a fold along an edge is no intersection.
    """
    corners = np.ascontiguousarray(mesh.vertices[mesh.triangles])
    found = np.zeros(len(corners), dtype=np.bool_)
    for first, second in _near_pairs(corners):
        _mark(corners, mesh.triangles, first, second, found)
    return np.flatnonzero(found)


def _near_pairs(corners: NDArray[np.float64]) -> list[tuple[Ints, Ints]]:
    """Pairs of triangles whose balls about the centroids meet, found between classes of triangles of one size."""
    centroid = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centroid[:, None], axis=2).max(axis=1)
    level = np.floor(np.log(np.maximum(radius, np.finfo(float).tiny)) / np.log(_SIZES))
    classes = [np.flatnonzero(level == value) for value in np.unique(level)]
    trees = [cKDTree(centroid[members]) for members in classes]
    pairs = []
    for i, large in enumerate(classes):
        for j, small in enumerate(classes[: i + 1]):
            reach = float(radius[large].max() + radius[small].max())
            near = trees[i].sparse_distance_matrix(trees[j], reach, output_type="coo_matrix")
            a, b = large[near.row], small[near.col]
            met = (near.data <= radius[a] + radius[b]) & ((a < b) | (i != j))
            pairs.append((a[met], b[met]))
    return pairs


@compiled
def _mark(corners, triangles, first, second, found):  # type: ignore[no-untyped-def]
    for k in range(len(first)):
        f, g = first[k], second[k]
        if found[f] and found[g]:
            continue
        shared, in_f, in_g = 0, -1, -1
        for i in range(3):
            for j in range(3):
                if triangles[f, i] == triangles[g, j]:
                    shared, in_f, in_g = shared + 1, i, j
        if shared > 1:
            continue
        if shared == 1:
            meet = _side_meets(corners[f], in_f, corners[g]) or _side_meets(corners[g], in_g, corners[f])
        else:
            meet = False
            for i in range(3):
                meet = meet or _side_meets(corners[f], i, corners[g]) or _side_meets(corners[g], i, corners[f])
        if meet:
            found[f] = found[g] = True


@compiled(inline=True)
def _volume(a, b, c, d):  # type: ignore[no-untyped-def]
    u0, u1, u2 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    v0, v1, v2 = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    w0, w1, w2 = d[0] - a[0], d[1] - a[1], d[2] - a[2]
    return u0 * (v1 * w2 - v2 * w1) + u1 * (v2 * w0 - v0 * w2) + u2 * (v0 * w1 - v1 * w0)


@compiled
def _side_meets(x, corner, y):  # type: ignore[no-untyped-def]
    """Whether the side of triangle x opposite to a corner passes through the inside of triangle y."""
    p, q = x[(corner + 1) % 3], x[(corner + 2) % 3]
    a, b = _volume(y[0], y[1], y[2], p), _volume(y[0], y[1], y[2], q)
    if a * b >= 0:
        return False
    s, t, u = _volume(p, q, y[0], y[1]), _volume(p, q, y[1], y[2]), _volume(p, q, y[2], y[0])
    return (s > 0 and t > 0 and u > 0) or (s < 0 and t < 0 and u < 0)
