"""Border curve: a loop of the boundary of a surface by its arc length in space, and where it runs in X/H."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.meshes.loops import boundary_loops
from orbiframe.meshes.submesh import submesh
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Parts of an edge of the refined mesh that are taken for straight.
_PARTS = 8


@dataclass(frozen=True, eq=False)
class BorderCurve:
    """A loop of the boundary of a surface, before the surface is placed in space.

    halfedges: (m,), those of the refined mesh in the order of the walk; forward: (m,), those that run its way.

    >>> from orbiframe import fit, read
    >>> from orbiframe.meshes import component
    >>> from orbiframe.surfaces import border_curves
    >>> import numpy as np
    >>> a = np.arange(12) * np.pi / 6
    >>> rings = [np.stack([np.cos(a), np.sin(a), 0 * a + z / 2], axis=1) for z in range(5)]
    >>> faces = [[12 * z + i, 12 * z + (i + 1) % 12, 12 * z + 12 + (i + 1) % 12, 12 * z + 12 + i]
    ...          for z in range(4) for i in range(12)]
    >>> tube = fit((np.concatenate(rings), np.array(faces)), size=100, boundary="auto").surface
    >>> [round(curve.length * tube.scale, 1) for curve in border_curves(tube)]
    [6.3, 6.3]
    """

    surface: OrbifoldSurface
    halfedges: Ints
    forward: Bools

    @cached_property
    def way(self) -> Floats:
        """The arc length from the beginning to every eighth of an edge, (8 m + 1,)."""
        at = np.arange(len(self.halfedges) * _PARTS + 1) / _PARTS
        places = self.surface.basis.values(self._points(at), self.surface.coefficients)
        return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])

    @property
    def length(self) -> float:
        """The length of the whole loop."""
        return float(self.way[-1])

    def points(self, arc: ArrayLike) -> Points:
        """The points of X/H at arc lengths (n,), which are taken modulo the length of the loop."""
        return self._points(self._at(arc))

    def corners(self, angle: float) -> tuple[Floats, Floats]:
        """The arc lengths at which the loop turns by more than an angle, and by how much, in radians."""
        at = np.arange(len(self.way)) / _PARTS
        places = self.surface.basis.values(self._points(at), self.surface.coefficients)
        way = np.diff(places, axis=0)
        way /= np.maximum(np.linalg.norm(way, axis=1), np.finfo(float).tiny)[:, None]
        behind, ahead = np.roll(way[_PARTS - 1 :: _PARTS], 1, axis=0), way[::_PARTS]
        turn = 2 * np.arcsin(np.minimum(np.linalg.norm(ahead - behind, axis=1) / 2, 1.0))
        sharp = np.flatnonzero(turn > angle)
        return self.way[sharp * _PARTS], turn[sharp]

    def geodesics(self, start: Floats, end: Floats) -> tuple[Ints, Floats, Floats]:
        """What geodesics begin with as the loop does from arc lengths start to end, (n,) each, and end at: the patch,
        (n,), and both ends in its frame, (n, 3) each. An end that is not after its start is a loop farther on.
        """
        end = np.where(end > start, end, end + self.length)
        first, last = self._at(start), self._at(end)
        first, last = np.floor(first).astype(np.intp), np.floor(last).astype(np.intp)
        last += np.where(end >= self.length, len(self.halfedges), 0)
        here, there = self.points(start), self.points(end)
        frames = np.array([self._carried(a, b) for a, b in zip(first.tolist(), last.tolist(), strict=True)])
        return here.patch, here.x, self.surface.orbifold.geometry.act(frames, there.x)

    def unrolled(self, start: float, arc: Floats) -> tuple[int, Floats]:
        """Points at rising arc lengths, (n,), from a start on, in the frame of one patch: the patch, and (n, 3)."""
        first = int(np.floor(self._at([start])[0]))
        edge = np.floor(self._at(arc)).astype(np.intp) + np.where(arc >= self.length, len(self.halfedges), 0)
        there, frame, reached = self.points(arc), np.eye(3), first
        x = np.empty((len(arc), 3))
        for k, last in enumerate(edge.tolist()):
            frame, reached = frame @ self._carried(reached, last), last
            x[k] = self.surface.orbifold.geometry.act(frame, there.x[k])
        return int(self.points([start]).patch[0]), x

    def knots(self, start: float, end: float) -> Floats:
        """Arc lengths of the vertices of the refined mesh between two, beyond the end of the loop too."""
        own = np.concatenate([self.way[:-1:_PARTS] + turn * self.length for turn in (0, 1)])
        return np.asarray(own[(own > start) & (own < end)])

    def on_left(self, arc: float) -> bool:
        """Whether the surface lies on the left of the walk, in the frame of the patch of the point at an arc length."""
        edge = min(int(np.floor(self._at([arc])[0])), len(self.halfedges) - 1)
        lifts = self.surface.triangulation.lifts[self.halfedges[edge] // 3]
        return bool((np.linalg.det(lifts) > 0) == self.forward[edge])

    def _carried(self, first: int, last: int) -> Floats:
        """The isometry from the frame of one edge of the loop to that of another, along it."""
        found, count = np.eye(3), len(self.halfedges)
        for k in range(first, last):
            found = found @ self._steps[k % count]
        return found

    @cached_property
    def _steps(self) -> Floats:
        """The isometries from the frame of the next edge's triangle to that of each, round their common vertex."""
        flat, geometry = self.surface.triangulation, self.surface.orbifold.geometry
        face, corner = np.divmod(self.halfedges, 3)
        start, end = (np.where(self.forward == ahead, corner, (corner + 1) % 3) for ahead in (True, False))
        frame = flat.orbifold.atlas.isometry[flat.corner_transitions[face]]
        rows = np.arange(len(face))
        back = geometry.inverse(np.roll(frame[rows, start], -1, axis=0))
        return np.asarray(frame[rows, end] @ back)

    def _at(self, arc: ArrayLike) -> Floats:
        """The number of the edge and the share of it, as one number, at arc lengths (n,)."""
        at = np.arange(len(self.way)) / _PARTS
        return np.interp(np.asarray(arc, dtype=np.float64) % self.length, self.way, at)

    def _points(self, at: Floats) -> Points:
        """The points at numbers of edges with shares of them, (n,); the end is that of the last edge."""
        edge = np.minimum(np.floor(at).astype(np.intp), len(self.halfedges) - 1)
        share = np.where(self.forward[edge], at - edge, 1 - (at - edge))
        rows, barycentric = np.arange(len(edge)), np.zeros((len(edge), 3))
        face, corner = np.divmod(self.halfedges[edge], 3)
        barycentric[rows, corner], barycentric[rows, (corner + 1) % 3] = 1 - share, share
        return self.surface.triangulation.locate(face, barycentric)


def border_curves(surface: OrbifoldSurface) -> list[BorderCurve]:
    """The loops of the boundary of a surface; none of a closed one."""
    flat = surface.triangulation
    if flat.inside is None:
        return []
    own, mesh = np.flatnonzero(flat.inside[flat.polyhedron.face]), submesh(flat.polyhedron, flat.inside).mesh
    return [BorderCurve(surface, own[loop.halfedges], loop.forward(mesh)) for loop in boundary_loops(mesh)]
