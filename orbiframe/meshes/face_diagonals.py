"""Diagonals: polygon faces cut into triangles for the map, without a fan in a concave face."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import TopologyError
from orbiframe.meshes.cut import Cut
from orbiframe.meshes.face_plane import in_its_plane
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.shared_diagonals import without_shared_diagonals

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

RULE = "the shortest diagonal inside the face, again and again"

_TIE = 1e-9


def triangulated(polyhedron: Polyhedron) -> Polyhedron:
    """The polyhedron with every face of n corners cut by n - 3 diagonals into triangles.

    A quadrilateral gets the diagonal whose two triangles face the same way as the quadrilateral (so a concave one is
    cut through its reflex corner), then the shorter one, then the one through the smaller vertex index. Larger faces
    lose their ear with the shortest diagonal, again and again, in the plane of their vector area. Triangles follow
    the order of the faces.

    No diagonal has the ends of an edge or of another diagonal: a later one is exchanged for the other diagonal of its
    quadrilateral, and where that is not free, or would leave the face, it gets a point in its middle, a new vertex
    after the others. So a surface that is closed by the vertices of its faces stays closed by them. Complexity: about
    n log n in the corners. Raises TopologyError for a face of fewer than three corners.
    """
    if polyhedron.is_triangular:
        return polyhedron
    return _glued(cut_into_triangles(polyhedron))


def outline(polyhedron: Polyhedron) -> Ints:
    """The halfedge of `triangulated(polyhedron)` that is each halfedge of the polyhedron, (H,)."""
    cut = cut_into_triangles(polyhedron)
    old = np.flatnonzero(cut.on_outline)
    place = np.empty(len(polyhedron.tail), dtype=np.intp)
    place[cut.sides[0][old]] = old
    return place


def cut_into_triangles(polyhedron: Polyhedron) -> Cut:
    """The triangles of `triangulated(polyhedron)` as corners of the polyhedron, and the points between them."""
    none = np.empty((0, 2), dtype=np.intp)
    if polyhedron.is_triangular:
        faces = np.arange(polyhedron.face_count)
        return Cut(polyhedron, np.arange(len(polyhedron.tail)).reshape(-1, 3), faces, none)
    small = np.flatnonzero(polyhedron.face_sizes < 3)
    if len(small):
        corners = polyhedron.face_sizes[small[0]]
        raise TopologyError(f"face {small[0]} has {corners} corners, a polygon needs three; remove it from the mesh")
    face = np.repeat(np.arange(polyhedron.face_count), polyhedron.face_sizes - 2)
    return without_shared_diagonals(Cut(polyhedron, _by_diagonals(polyhedron), face, none))


def _by_diagonals(polyhedron: Polyhedron) -> Ints:
    """The triangles of all faces, (T, 3), each face cut as if it were alone."""
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
    for face in map(int, np.flatnonzero(sizes > 4)):
        from orbiframe.meshes.ear_clipping import cut_ears

        flat = in_its_plane(polyhedron.vertices[polyhedron.face_corners(face)])
        corners[first[face] : first[face + 1]] = polyhedron.offsets[face] + cut_ears(flat)[0]
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


def _glued(cut: Cut) -> Polyhedron:
    """The triangles with their twins: old edges keep theirs, the two sides of a diagonal find each other."""
    mesh, (start, end), old = cut.polyhedron, cut.sides, cut.on_outline
    place = np.full(len(mesh.tail) + 1, -1, dtype=np.intp)
    place[start[old]] = np.flatnonzero(old)
    twin = np.full(len(start), -1, dtype=np.intp)
    twin[old] = place[mesh.twin[start[old]]]
    same = np.zeros(len(start), dtype=np.bool_)
    same[old] = mesh.same[start[old]]
    inner = np.flatnonzero(~old)
    order = inner[np.lexsort((np.maximum(start, end)[inner], np.minimum(start, end)[inner]))]
    twin[order[0::2]], twin[order[1::2]] = order[1::2], order[0::2]
    return replace(
        mesh,
        vertices=_grown_rows(mesh.vertices, cut),
        offsets=np.arange(len(cut.corners) + 1) * 3,
        tail=cut.vertex[start],
        twin=twin,
        same=same,
        normals=_grown(mesh.normals, cut),
        colors=_grown(mesh.colors, cut),
        face_colors=None if mesh.face_colors is None else mesh.face_colors[cut.face],
    )


def _grown(table: Floats | None, cut: Cut) -> Floats | None:
    return None if table is None else _grown_rows(table, cut)


def _grown_rows(table: Floats, cut: Cut) -> Floats:
    """A table of the vertices with rows for the new ones, the means of the two that each lies between."""
    ends = cut.polyhedron.tail[cut.between]
    return np.concatenate([table, table[ends[:, 0]] / 2 + table[ends[:, 1]] / 2])
