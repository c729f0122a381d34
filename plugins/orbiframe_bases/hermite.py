"""Cubic Hermite data: a first jet at every vertex and one derivative across every edge."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from orbiframe.splines import Sectors, Unknowns, VertexJets, shaped_triangles, shared_normals
from orbiframe.triangulations import GeodesicTriangulation

Floats = NDArray[np.float64]


class CubicHermite:
    """The data of C1 cubic elements, 3 V + E unknowns, and what they say of the cubic pieces beside vertices and edges.

    With B the blossom of a piece, the unknowns are the linear form u -> B(v, v, u) at every vertex v, by its values at
    the corners of a triangle about v, and B(v_i, v_j, n) with the normal n of every edge.
    """

    def __init__(self, domain: GeodesicTriangulation) -> None:
        self.domain = domain
        self._sectors = Sectors(domain) if domain.crease is not None else None
        self.unknowns = Unknowns(domain, 3, 1, 0, self._sectors)

    @cached_property
    def _jets(self) -> VertexJets:
        triangles, sectors = shaped_triangles(self.domain, neighbours(self.domain), 0.8), self._sectors
        if sectors is None:
            return VertexJets(self.domain, 1, triangles)
        return VertexJets(self.domain, 1, sectors.triangles(triangles), sectors.corner)

    @cached_property
    def _normals(self) -> Floats:
        return normal_coordinates(self.domain)

    def forms(self, faces: slice) -> tuple[Floats, Floats]:
        """B(v_c, v_c, v_(c + m)) for corners c, (N, 3, m, 12), and B(v_1, v_2, v_3) as each edge wants it, (N, 3, 12).

        As forms of the unknowns of each triangle of a range. With n = a v_i + b v_j + g v_k on edge ij, the edge wants
        B(v_i, v_j, v_k) = (B(v_i, v_j, n) - a B(v_i, v_i, v_j) - b B(v_i, v_j, v_j)) / g.
        """
        own = self._jets.own_forms(faces)
        corner = np.zeros((len(own), 3, 3, self.unknowns.local_size))
        for c in range(3):
            corner[:, c, :, self.unknowns.vertex_slots(c)] = own[:, c]
        a, b, g = np.moveaxis(self._normals[faces, :, :, None], 2, 0)
        wanted = -a * corner[:, :, 1] - b * np.roll(corner[:, :, 2], -1, axis=1)
        for e in range(3):
            wanted[:, e, self.unknowns.edge_slots(e)] += 1
        return corner, wanted / g

    @cached_property
    def one(self) -> Floats:
        """The data of the function 1: B(v, v, u) = beta(v, u), 1 on the tangent plane, and no slope across edges."""
        edges = self.domain.edge_count if self._sectors is None else self._sectors.side_count
        return np.repeat([1.0, 0.0], [self.unknowns.size - edges, edges])

    @cached_property
    def pattern(self) -> NDArray[np.bool_]:
        """Which unknowns matter to B(v_1, v_2, v_3) as each edge wants it, (3, 12): its ends and itself."""
        pattern = np.zeros((3, self.unknowns.local_size), dtype=np.bool_)
        for e in range(3):
            for slots in (self.unknowns.vertex_slots(e), self.unknowns.vertex_slots((e + 1) % 3)):
                pattern[e, slots] = True
            pattern[e, self.unknowns.edge_slots(e)] = True
        return pattern


def neighbours(domain: GeodesicTriangulation) -> Floats:
    """The other two corners of the triangle, for every corner, (F, 3, 2, 3)."""
    return np.stack([np.roll(domain.corners, -1, axis=1), np.roll(domain.corners, -2, axis=1)], axis=2)


def normal_coordinates(domain: GeodesicTriangulation) -> Floats:
    """The coordinates of the shared normal of each edge on v_c, v_(c + 1), v_(c + 2), in this order: (F, 3, 3)."""
    normals = shared_normals(domain).reshape(-1, 3, 3)
    coordinates = normals @ np.linalg.inv(domain.corners)
    turned = (np.arange(3)[:, None] + np.arange(3)) % 3
    return np.asarray(np.take_along_axis(coordinates, np.broadcast_to(turned, coordinates.shape), axis=2))
