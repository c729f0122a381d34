"""Rings: faces as cyclic lists, cut where they meet themselves and joined where they are flat."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import faces_without_area

Ints = NDArray[np.intp]


def with_faces(polyhedron: Polyhedron, corners: Ints, start: Ints, size: Ints, owner: Ints) -> Polyhedron:
    """Other faces on the same vertices: `size` corners from `start` on, with the colours of the faces `owner`.

    Halfedges find their twins by their ends, as in a file.
    """
    offsets = np.append(0, np.cumsum(size))
    place = np.repeat(start - offsets[:-1], size) + np.arange(offsets[-1])
    return Polyhedron.from_corners(
        polyhedron.vertices,
        offsets,
        corners[place],
        normals=polyhedron.normals,
        colors=polyhedron.colors,
        face_colors=None if polyhedron.face_colors is None else polyhedron.face_colors[owner],
        unit=polyhedron.unit,
    )


def simple_loops(corners: Sequence[int]) -> list[list[int]]:
    """The loops of three or more corners that a closed walk falls apart into, if it is cut wherever it meets itself."""
    loops: list[list[int]] = []
    path: list[int] = []
    for corner in corners:
        if corner in path:
            place = path.index(corner)
            loops.append(path[place:])
            del path[place:]
        path.append(corner)
    return [loop for loop in [*loops, path] if len(loop) > 2]


def without_flat_faces(polyhedron: Polyhedron) -> tuple[Polyhedron, FlatFaces]:
    """The polyhedron in which faces without area are parts of others, and what became of them.

    Such a face joins its neighbour across its longest edge, which opens no hole. It is dropped where that edge is open,
    and kept where the neighbour would meet a vertex twice.
    """
    joined = dropped = 0
    while True:
        flat = faces_without_area(polyhedron).tolist()
        rings = _Rings(_turned_to_neighbours(polyhedron, flat))
        changes = [rings.settle(face) for face in flat]
        if not any(changes):
            return polyhedron, FlatFaces(joined, dropped, len(flat))
        joined += changes.count("joined")
        dropped += changes.count("dropped")
        polyhedron = rings.polyhedron()


def _turned_to_neighbours(polyhedron: Polyhedron, flat: list[int]) -> Polyhedron:
    """Flat faces, which have no side of their own, run as their neighbours across the longest edges do."""
    rings = _Rings(polyhedron)
    flip = np.zeros(polyhedron.face_count, dtype=np.bool_)
    loose = set(flat)
    for face in flat:
        halfedge = rings.longest(face)
        other = int(polyhedron.face[polyhedron.twin[halfedge]])
        free = next((f for f in (face, other) if f in loose), None)
        if free is not None and polyhedron.same[halfedge] ^ flip[face] ^ flip[other]:
            flip[free] = True
        loose -= {face, other}
    return reversed_faces(polyhedron, flip) if flip.any() else polyhedron


class FlatFaces(NamedTuple):
    """What became of the faces without area: how many joined a neighbour, were dropped, and were kept."""

    joined: int
    dropped: int
    kept: int


class _Rings:
    """The faces of a polyhedron as rings of halfedges; only those that change are written down."""

    def __init__(self, polyhedron: Polyhedron) -> None:
        self._mesh = polyhedron
        self._ring: dict[int, list[int]] = {}
        self._owner: dict[int, int] = {}
        self.gone: set[int] = set()

    def longest(self, face: int) -> int:
        """The halfedge of a face's longest edge; of edges alike, an open one, then the one of the largest vertices."""

        def rank(halfedge: int) -> tuple[float, bool, list[int]]:
            mesh = self._mesh
            ends = sorted([int(mesh.tail[halfedge]), int(mesh.head[halfedge])])
            return float(mesh.edge_lengths[halfedge]), bool(mesh.twin[halfedge] < 0), ends

        return max(self._of(face), key=rank)

    def settle(self, face: int) -> str:
        """Let a face join its neighbour across the longest edge, or go; returns what happened, if anything."""
        halfedge = self.longest(face)
        other = self._neighbour(halfedge)
        if other is None:
            self.gone.add(face)
            return "dropped"
        return "joined" if self._join(face, halfedge, other) else ""

    def _of(self, face: int) -> list[int]:
        offsets = self._mesh.offsets
        return self._ring.get(face) or list(range(offsets[face], offsets[face + 1]))

    def _neighbour(self, halfedge: int) -> int | None:
        """The face on the other side of an edge, None where there is none."""
        twin = int(self._mesh.twin[halfedge])
        face = self._owner.get(twin, int(self._mesh.face[twin]))
        return None if twin < 0 or face in self.gone else face

    def _join(self, face: int, halfedge: int, other: int) -> bool:
        """Give the corners of a face to the neighbour across an edge; False where that would meet a vertex twice."""
        if other == face or self._mesh.same[halfedge]:
            return False
        rest = _after(self._of(face), halfedge)
        merged = self._without_spikes(rest + _after(self._of(other), int(self._mesh.twin[halfedge])))
        corners = {int(self._mesh.tail[h]) for h in merged}
        if len(merged) < 3 or len(corners) < len(merged):
            return False
        self._ring[other] = merged
        self._owner.update(dict.fromkeys(rest, other))
        self.gone.add(face)
        return True

    def _without_spikes(self, ring: list[int]) -> list[int]:
        """A ring without edges that it runs along there and back at once."""
        path: list[int] = []
        for halfedge in ring:
            if path and self._mesh.twin[path[-1]] == halfedge:
                path.pop()
            else:
                path.append(halfedge)
        while len(path) > 1 and self._mesh.twin[path[0]] == path[-1]:
            path = path[1:-1]
        return path

    def polyhedron(self) -> Polyhedron:
        """The polyhedron of the faces that are left, in their order."""
        mesh = self._mesh
        start, size = mesh.offsets[:-1].copy(), mesh.face_sizes.copy()
        changed = {face: ring for face, ring in self._ring.items() if face not in self.gone}
        corners = np.concatenate([mesh.tail, *(mesh.tail[ring] for ring in changed.values())])
        faces = np.array(list(changed), dtype=np.intp)
        size[faces] = [len(ring) for ring in changed.values()]
        start[faces] = len(mesh.tail) + np.cumsum(size[faces]) - size[faces]
        left = np.setdiff1d(np.arange(mesh.face_count), np.array(list(self.gone), dtype=np.intp))
        return with_faces(mesh, corners, start[left], size[left], left)


def _after(ring: list[int], halfedge: int) -> list[int]:
    """The other halfedges of a ring, from the one after a given one on."""
    place = ring.index(halfedge)
    return ring[place + 1 :] + ring[:place]
