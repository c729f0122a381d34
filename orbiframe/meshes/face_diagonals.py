"""Diagonals: polygon faces cut into triangles for the map, without a fan in a concave face."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.compiled.decorator import compiled
from orbiframe.errors import TopologyError
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

RULE = "the shortest diagonal inside the face, again and again"

_TIE = 1e-9


def triangulated(polyhedron: Polyhedron) -> Polyhedron:
    """The polyhedron with every face of n corners cut by n - 3 diagonals into triangles.

    A quadrilateral gets the diagonal whose two triangles face the same way as the quadrilateral (so a concave one is
    cut through its reflex corner), then the shorter one, then the one through the smaller vertex index. Larger faces
    lose their ear with the shortest diagonal, again and again, in the plane of their vector area. Triangles follow
    the order of the faces. No vertex is added, and diagonals become twins even where an edge with the same ends
    exists. Complexity: linear for quadrilaterals, about quadratic in the corners of larger faces. Raises TopologyError
    for a face of fewer than three corners.
    """
    if polyhedron.is_triangular:
        return polyhedron
    small = np.flatnonzero(polyhedron.face_sizes < 3)
    if len(small):
        corners = polyhedron.face_sizes[small[0]]
        raise TopologyError(f"face {small[0]} has {corners} corners, a polygon needs three; remove it from the mesh")
    return _glued(polyhedron, triangle_corners(polyhedron))


def triangle_owner(polyhedron: Polyhedron) -> Ints:
    """The face that each triangle of `triangulated(polyhedron)` comes from, (T,)."""
    return np.repeat(np.arange(polyhedron.face_count), polyhedron.face_sizes - 2)


def outline(polyhedron: Polyhedron) -> Ints:
    """The halfedge of `triangulated(polyhedron)` that is each halfedge of the polyhedron, (H,)."""
    corners = triangle_corners(polyhedron)
    start, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    old = np.flatnonzero(polyhedron.next[start] == end)
    place = np.empty(len(polyhedron.tail), dtype=np.intp)
    place[start[old]] = old
    return place


def triangle_corners(polyhedron: Polyhedron) -> Ints:
    """The triangles of `triangulated(polyhedron)` as corners (halfedges) of the polyhedron, (T, 3)."""
    if polyhedron.is_triangular:
        return np.arange(len(polyhedron.tail)).reshape(-1, 3)
    sizes = polyhedron.face_sizes
    first = np.concatenate([[0], np.cumsum(sizes - 2)])
    corners = np.empty((first[-1], 3), dtype=np.intp)
    plain = np.flatnonzero(sizes == 3)
    corners[first[plain]] = polyhedron.offsets[plain][:, None] + np.arange(3)
    quads = np.flatnonzero(sizes == 4)
    turn = _quad_turns(polyhedron, quads)[:, None]
    start = polyhedron.offsets[quads][:, None]
    corners[first[quads]] = start + (np.array([0, 1, 2]) + turn) % 4
    corners[first[quads] + 1] = start + (np.array([0, 2, 3]) + turn) % 4
    normals = vector_areas(polyhedron)
    for face in map(int, np.flatnonzero(sizes > 4)):
        flat = _flattened(polyhedron.vertices[polyhedron.face_corners(face)], normals[face])
        corners[first[face] : first[face + 1]] = polyhedron.offsets[face] + _cut_ears(flat)
    return corners


def _quad_turns(polyhedron: Polyhedron, quads: Ints) -> Ints:
    """0 where the diagonal joins corners 0 and 2, 1 where it joins corners 1 and 3, (Q,)."""
    index = polyhedron.tail[polyhedron.offsets[quads][:, None] + np.arange(4)]
    p = polyhedron.vertices[index]
    normal = np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1])
    before, after = p - np.roll(p, 1, axis=1), np.roll(p, -1, axis=1) - p
    convex = np.einsum("qci,qi->qc", np.cross(before, after), normal)
    # The diagonal 0-2 makes triangles (0, 1, 2) and (0, 2, 3): both face with the normal if corners 1 and 3 are convex.
    worst = np.stack([convex[:, [1, 3]].min(axis=1), convex[:, [0, 2]].min(axis=1)]) > 0
    length = np.stack([np.linalg.norm(p[:, 2] - p[:, 0], axis=1), np.linalg.norm(p[:, 3] - p[:, 1], axis=1)])
    tied = np.abs(length[1] - length[0]) <= _TIE * (length[0] + length[1])
    by_index = index[:, [1, 3]].min(axis=1) < index[:, [0, 2]].min(axis=1)
    shorter = np.where(tied, by_index, length[1] < length[0])
    return np.asarray(np.where(worst[0] == worst[1], shorter, worst[1]), dtype=np.intp)


def _flattened(points: Floats, normal: Floats) -> Floats:
    """The corners of a face in coordinates of the plane across its normal, (n, 2), counterclockwise."""
    size = float(np.linalg.norm(normal))
    n = normal / size if size > 0 else np.array([0.0, 0.0, 1.0])
    axis = np.eye(3)[np.argmin(np.abs(n))]
    u = np.cross(axis, n)
    u /= np.linalg.norm(u)
    centred = points - points.mean(axis=0)
    return np.stack([centred @ u, centred @ np.cross(n, u)], axis=1)


@compiled
def _cross(a: Floats, b: Floats, c: Floats) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])  # type: ignore[no-any-return]


@compiled
def _is_ear(p: Floats, before: Ints, after: Ints, ear: int) -> bool:
    a, b, c = before[ear], ear, after[ear]
    if _cross(p[a], p[b], p[c]) <= 0.0:
        return False
    other = after[c]
    while other != a:
        inside = (
            _cross(p[a], p[b], p[other]) >= 0.0
            and _cross(p[b], p[c], p[other]) >= 0.0
            and _cross(p[c], p[a], p[other]) >= 0.0
        )
        if inside:
            return False
        other = after[other]
    return True


@compiled
def _shortest_ear(p: Floats, before: Ints, after: Ints, start: int, checked: bool) -> int:
    best, best_length, ear = -1, np.inf, start
    while True:
        a, c = before[ear], after[ear]
        length = (p[a, 0] - p[c, 0]) ** 2 + (p[a, 1] - p[c, 1]) ** 2
        if length < best_length * (1.0 - 1e-9) and (not checked or _is_ear(p, before, after, ear)):
            best, best_length = ear, length
        ear = after[ear]
        if ear == start:
            return best


@compiled
def _cut_ears(p: Floats) -> Ints:
    """Triangles (n - 2, 3) of a polygon (n, 2); where no ear is left (a crossing polygon) the shortest cut is taken."""
    n = len(p)
    before, after = np.arange(-1, n - 1), np.arange(1, n + 1)
    before[0], after[n - 1] = n - 1, 0
    triangles = np.empty((n - 2, 3), dtype=np.intp)
    start = 0
    for t in range(n - 2):
        ear = _shortest_ear(p, before, after, start, True)
        if ear < 0:
            ear = _shortest_ear(p, before, after, start, False)
        if ear < 0:
            ear = start
        a, c = before[ear], after[ear]
        triangles[t, 0], triangles[t, 1], triangles[t, 2] = a, ear, c
        after[a], before[c] = c, a
        start = c
    return triangles


def _glued(polyhedron: Polyhedron, corners: Ints) -> Polyhedron:
    """The triangles with their twins: old edges keep theirs, the two sides of a diagonal find each other."""
    start = corners.ravel()
    end = np.roll(corners, -1, axis=1).ravel()
    size = len(start)
    old = polyhedron.next[start] == end
    place = np.full(len(polyhedron.tail) + 1, -1, dtype=np.intp)
    place[start[old]] = np.flatnonzero(old)
    twin = np.full(size, -1, dtype=np.intp)
    twin[old] = place[polyhedron.twin[start[old]]]
    same = np.zeros(size, dtype=np.bool_)
    same[old] = polyhedron.same[start[old]]
    cut = np.flatnonzero(~old)
    order = cut[np.lexsort((np.maximum(start, end)[cut], np.minimum(start, end)[cut]))]
    twin[order[0::2]], twin[order[1::2]] = order[1::2], order[0::2]
    owner = triangle_owner(polyhedron)
    return Polyhedron(
        polyhedron.vertices,
        np.arange(len(corners) + 1) * 3,
        polyhedron.tail[start],
        twin,
        same,
        polyhedron.normals,
        polyhedron.colors,
        None if polyhedron.face_colors is None else polyhedron.face_colors[owner],
    )
