"""Polyhedron: vertices in space, polygon faces of any size, and halfedges that know their twins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.errors import TopologyError
from orbiframe.meshes.marked_edges import MarkedEdges

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# From so many halfedges on, a compiled loop gains more time than the import of the compiler takes.
LARGE = 2**20


# What follows from the faces alone, wherever the vertices are.
_OF_FACES = ("face_sizes", "face", "next", "head", "representative", "edge", "is_triangular", "triangles", "sheets")


# The units that coordinates may have.
UNITS = ("millimetre", "metre")


@dataclass(frozen=True, eq=False, repr=False)
class Polyhedron:
    """A complex of polygons in space, closed or not, orientable or not.

    Halfedge h is corner h of the list of all face corners, face by face, and runs from `tail[h]` to the tail of the
    next corner of its face. Two halfedges that are glued are twins; the side flag `same[h]` says that the twin runs
    the same way, as happens on faces that are not oriented alike and on every nonorientable surface. Two vertices
    may share several edges: an edge is its pair of halfedges, not its pair of ends.

    vertices: (V, 3); offsets: (F + 1,), face f has the halfedges offsets[f] to offsets[f + 1] - 1; tail, twin, same:
    (H,); twin is -1 where an edge lies in one face only, or in three or more. Optional, as far as a file has them:
    normals (V, 3), colors (V, 3 or 4) and face_colors (F, 3 or 4), colours from 0 to 1; unit, that of the coordinates:
    "millimetre" or "metre"; corner_normals (H, 3), of every corner of every face, where they are not those of the
    vertices: beside creases; corner_uv (H, 2), texture coordinates of every corner of every face; marked, the edges
    that a file says are sharp.

    >>> import numpy as np
    >>> from orbiframe import Polyhedron
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> mesh = Polyhedron.of((np.array(corners), [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
    >>> mesh
    <Polyhedron: 4 vertices, 6 edges, 4 faces>
    >>> print(mesh.next[0], mesh.head[0], mesh.twin[mesh.twin[0]])  # of the halfedge from vertex 0 to 2
    1 2 0
    """

    vertices: Floats
    offsets: Ints
    tail: Ints
    twin: Ints
    same: Bools
    normals: Floats | None = None
    colors: Floats | None = None
    face_colors: Floats | None = None
    unit: str | None = None
    corner_normals: Floats | None = None
    corner_uv: Floats | None = None
    marked: MarkedEdges | None = None

    @classmethod
    def from_corners(
        cls,
        vertices: ArrayLike,
        offsets: ArrayLike,
        tail: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        face_colors: ArrayLike | None = None,
        unit: str | None = None,
    ) -> Polyhedron:
        """The polyhedron of faces given by their corners: halfedges with the same two ends are twins.

        vertices: (V, 3); offsets: (F + 1,); tail: (H,) vertex index of every corner. Edges with one halfedge, or with
        three or more, get twin -1 (`topology.defects` names them). Raises TopologyError for an index out of range.
        """
        points = np.ascontiguousarray(vertices, dtype=np.float64).reshape(-1, 3)
        ends = np.ascontiguousarray(tail, dtype=np.intp)
        starts = np.ascontiguousarray(offsets, dtype=np.intp)
        _require_corners(len(points), starts, ends)
        twin, same = _twins_by_ends(len(points), starts, ends)
        tables = [None if a is None else np.asarray(a, dtype=np.float64) for a in (normals, colors, face_colors)]
        return cls(points, starts, ends, twin, same, tables[0], tables[1], tables[2], unit)

    @classmethod
    def from_faces(cls, vertices: ArrayLike, faces: Sequence[Sequence[int]] | NDArray[np.integer]) -> Polyhedron:
        """The polyhedron of a list of faces (sequences of vertex indices), or of an (F, n) array of equal faces."""
        if isinstance(faces, np.ndarray) and faces.ndim == 2:
            offsets = np.arange(len(faces) + 1) * faces.shape[1]
            return cls.from_corners(vertices, offsets, faces.ravel())
        offsets = np.cumsum([0, *(len(face) for face in faces)])
        return cls.from_corners(vertices, offsets, np.array([i for face in faces for i in face], dtype=np.intp))

    @classmethod
    def of(cls, mesh: object) -> Polyhedron:
        """The polyhedron of a mesh of another library, of a pair (vertices, faces), or of a polyhedron, itself.

        vertices: (V, 3); faces: (F, n), or a list of faces of any sizes. Else a mesh of trimesh, PyVista, meshio or
        Open3D. Raises UsageError for any other object, TopologyError for arrays of a wrong shape, type or range.
        """
        from orbiframe.meshes.foreign_meshes import polyhedron_of

        return polyhedron_of(mesh)

    def __repr__(self) -> str:
        return f"<Polyhedron: {len(self.vertices)} vertices, {self.edge_count} edges, {self.face_count} faces>"

    @property
    def face_count(self) -> int:
        """Number of faces."""
        return len(self.offsets) - 1

    @cached_property
    def face_sizes(self) -> Ints:
        """Number of corners of every face, (F,)."""
        return np.diff(self.offsets)

    @cached_property
    def face(self) -> Ints:
        """The face of every halfedge, (H,)."""
        return np.repeat(np.arange(self.face_count), self.face_sizes)

    @cached_property
    def next(self) -> Ints:
        """The next halfedge round the face, (H,)."""
        following = np.arange(1, len(self.tail) + 1)
        filled = self.face_sizes > 0
        following[self.offsets[1:][filled] - 1] = self.offsets[:-1][filled]
        return following

    @cached_property
    def head(self) -> Ints:
        """The end vertex of every halfedge, (H,)."""
        return self.tail[self.next]

    @cached_property
    def representative(self) -> Bools:
        """One halfedge of every edge is marked, (H,); the smaller of two twins."""
        index = np.arange(len(self.tail))
        return (self.twin < 0) | (index < self.twin)

    @cached_property
    def edge(self) -> Ints:
        """The edge of every halfedge, (H,); edges are numbered by their representative halfedges."""
        number = np.cumsum(self.representative) - 1
        index = np.arange(len(self.tail))
        return number[np.where(self.representative, index, self.twin)]

    @property
    def edge_count(self) -> int:
        """Number of edges; halfedges without a unique twin count as an edge each."""
        return int(self.representative.sum())

    @cached_property
    def is_triangular(self) -> bool:
        """Every face is a triangle."""
        return bool((self.face_sizes == 3).all())

    @cached_property
    def triangles(self) -> Ints:
        """The corners of a triangular polyhedron as an array, (F, 3). Raises TopologyError where a face is larger."""
        if not self.is_triangular:
            raise TopologyError("this step needs triangles; call triangulated(polyhedron) first")
        return self.tail.reshape(-1, 3)

    @cached_property
    def sheets(self) -> tuple[int, int, Ints]:
        """Components of the faces, and of their two-sheeted orientation cover, with its labels (2F,) of f and F + f."""
        from orbiframe.meshes.orientation import face_sheets

        return face_sheets(self)

    @cached_property
    def edge_lengths(self) -> Floats:
        """Length in space of every halfedge, (H,)."""
        return np.asarray(np.linalg.norm(self.vertices[self.head] - self.vertices[self.tail], axis=1))

    @cached_property
    def diagonal(self) -> float:
        """Diagonal of the bounding box of the vertices."""
        # hypot, because the squares of very large and very small numbers are none.
        return math.hypot(*np.ptp(self.vertices, axis=0)) if len(self.vertices) else 0.0

    def face_corners(self, face: int) -> Ints:
        """The vertices of one face in order."""
        return self.tail[self.offsets[face] : self.offsets[face + 1]]

    def with_vertices(self, vertices: Floats, normals: Floats | None = None) -> Polyhedron:
        """The same faces with other vertices (and normals); all but the normals of corners is kept."""
        found = replace(self, vertices=np.asarray(vertices, dtype=np.float64), normals=normals, corner_normals=None)
        # What is known of the faces is known of those too.
        found.__dict__.update({name: self.__dict__[name] for name in _OF_FACES if name in self.__dict__})
        return found

    def to_trimesh(self) -> Any:
        """A trimesh.Trimesh of triangles, with the normals if there are some; vertices keep their numbers."""
        from orbiframe.meshes.foreign_meshes import to_trimesh

        return to_trimesh(self)

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData of the polygons, with the normals as the array "Normals" if there are some."""
        from orbiframe.meshes.foreign_meshes import to_pyvista

        return to_pyvista(self)

    def to_meshio(self) -> Any:
        """A meshio.Mesh, a block of cells for every size of faces, with the normals as "Normals" if there are some."""
        from orbiframe.meshes.foreign_meshes import to_meshio

        return to_meshio(self)

    def to_open3d(self) -> Any:
        """An open3d.geometry.TriangleMesh, with the normals if there are some."""
        from orbiframe.meshes.foreign_meshes import to_open3d

        return to_open3d(self)


def _require_corners(vertex_count: int, offsets: Ints, tail: Ints) -> None:
    if len(offsets) == 0 or offsets[0] != 0 or offsets[-1] != len(tail) or (np.diff(offsets) < 0).any():
        raise TopologyError("face offsets must start at 0, never decrease and end at the number of corners")
    bad = np.flatnonzero((tail < 0) | (tail >= vertex_count))
    if len(bad):
        face = int(np.searchsorted(offsets, bad[0], side="right")) - 1
        raise TopologyError(
            f"face {face} names vertex {tail[bad[0]]}, but the vertices are 0 to {vertex_count - 1}; mend the face list"
        )


def _twins_by_ends(vertex_count: int, offsets: Ints, tail: Ints) -> tuple[Ints, Bools]:
    twin = np.full(len(tail), -1, dtype=np.intp)
    same = np.zeros(len(tail), dtype=np.bool_)
    if LARGE <= len(tail) < 2**31:
        from orbiframe.meshes.halfedge_twins import find_twins

        find_twins(vertex_count, offsets, tail, twin, same)
        return twin, same
    following = np.arange(1, len(tail) + 1)
    sizes = np.diff(offsets)
    following[offsets[1:][sizes > 0] - 1] = offsets[:-1][sizes > 0]
    head = tail[following]
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    key = low * np.intp(max(vertex_count, 1)) + high
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.diff(key[order], prepend=-1))
    pairs = first[np.diff(first, append=len(key)) == 2]
    a, b = order[pairs], order[pairs + 1]
    twin[a], twin[b] = b, a
    same[a] = same[b] = tail[a] == tail[b]
    return twin, same
