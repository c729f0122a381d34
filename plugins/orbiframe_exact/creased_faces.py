"""Creased faces: B-spline faces between creases, which end at planes where they have some beside them."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from orbiframe_exact.creased_domain import CreasedDomain
from orbiframe_exact.few_faces import FewFaces, dot, unit

Floats = NDArray[np.float64]


class CreasedFaces(FewFaces):
    """As `FewFaces`, but that faces have common tangent planes only where there is no crease.

    Edges beside a plane lie in it, and vertices where their planes meet. Where the surface itself has a small kink, as
    beside creases, both faces take the mean of the normals. Where a face goes over into a plane without a crease, its
    tangent planes are that plane.
    """

    domain: CreasedDomain

    intervals: ClassVar[int] = 2

    def _divide_limbs(self) -> None:
        """Triangles of the functions are small where limbs are."""

    def _fit_edges(self, edges: list[int]) -> None:
        super()._fit_edges(edges)
        planes = self.domain.planes
        for e in edges:
            poles, p = self.edge_poles[e], self.domain.at_plane[e]
            if p >= 0:
                poles = poles + np.outer(planes.offset[p] - poles @ planes.normal[p], planes.normal[p])
            poles[[0, -1]] = self.domain.places[self.domain.ends[e]]
            self.edge_poles[e] = poles

    def _border_normals(self, quads: list[int], at: list[Floats], own: Floats) -> Floats:
        side = np.repeat([4 * q + k for q in quads for k in range(4)], [len(u) for u in at])
        u, edge = np.concatenate(at), self.domain.edge.ravel()[side]
        common = own.copy()
        plane = self.domain.at_plane[edge]
        level = np.flatnonzero(self.domain.smooth[edge] & (plane >= 0))
        common[level] = self.domain.planes.normal[plane[level]]
        both = self.sides[edge]
        beside = np.flatnonzero(self.domain.smooth[edge] & (plane < 0) & (both[:, 1] >= 0))
        other = np.where(both[:, 0] == side, both[:, 1], both[:, 0])[beside]
        k = other % 4
        fixed = np.where((k == 1) | (k == 2), 1.0, 0.0)
        s, t = np.where(k % 2 == 0, u[beside], fixed), np.where(k % 2 == 0, fixed, u[beside])
        _, fs, ft = self.domain.points.jets(other // 4, s, t, 1)
        theirs = unit(np.cross(fs, ft))
        common[beside] = unit(own[beside] + theirs * np.where(dot(own[beside], theirs) < 0, -1.0, 1.0))
        return common

    def _both_normals(self, edge: int, sides: list[int], u: Floats) -> tuple[Floats, Floats]:
        one = self._normals(sides[0], u)
        if len(sides) > 1:
            return one, self._normals(sides[1], u)
        return one, np.broadcast_to(self.domain.planes.normal[self.domain.at_plane[edge]], one.shape)
