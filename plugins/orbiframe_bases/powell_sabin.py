"""Powell-Sabin splines: smooth piecewise polynomials on the split of every triangle in six."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import Orbifold, Triangulation
from orbiframe.delaunay import domain_for
from orbiframe.splines import (
    ElementBasis,
    PowellSabinSplit,
    Sectors,
    Unknowns,
    VertexJets,
    coefficient_count,
    edge_normals,
    enclosing_triangles,
    shaped_triangles,
)
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_bases.powell_sabin_nets import Pieces, powell_sabin_nets

Floats = NDArray[np.float64]

_ROTATED = (np.arange(3)[:, None] + np.arange(3)) % 3


class PowellSabin(ElementBasis):
    """Splines of one degree on the Powell-Sabin split of a triangulation of X/H through the incentres (paper, 3.3).

    The unknowns are jets of one order at the vertices, as Bernstein coefficients on a triangle on the tangent plane,
    and for some degrees one on every edge or one in every triangle.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself.

    vertex_triangles: (V, 3, 3), the triangles about the vertices, corners in columns, in the frames of the reference
    corners of the vertices.
    """

    polynomial_degree: ClassVar[int]
    jet_order: ClassVar[int]
    continuity: ClassVar[int]
    on_edge: ClassVar[int] = 0
    in_face: ClassVar[int] = 0

    def __init__(
        self, orbifold: Orbifold, triangulation: Triangulation | GeodesicTriangulation, *, size: int = 1000
    ) -> None:
        at_vertex = coefficient_count(self.jet_order)
        counts = at_vertex, self.on_edge, self.in_face
        domain = domain_for(orbifold, triangulation, size, counts, creases=self.crease_unknowns is not None)
        split = PowellSabinSplit(domain)
        self.vertex_triangles = self._triangles(split)
        sectors = Sectors(domain) if domain.crease is not None else None
        triangles = self.vertex_triangles if sectors is None else sectors.triangles(self.vertex_triangles)
        jets = VertexJets(domain, self.jet_order, triangles, None if sectors is None else sectors.corner)
        unknowns = Unknowns(domain, *counts, sectors)
        matrix = _matrix(self.polynomial_degree, split, jets, unknowns)
        super().__init__(domain, self.polynomial_degree, split.micro_triangles, matrix, self.continuity)

    def _triangles(self, split: PowellSabinSplit) -> Floats:
        """The triangles about the vertices on which the jets are given."""
        return shaped_triangles(split.domain, split.around, 1.4)


def _matrix(degree: int, split: PowellSabinSplit, jets: VertexJets, unknowns: Unknowns) -> csr_array:
    centre, share = split.coordinates(split.incentre)[:, _ROTATED], split.share
    normals = _normal_coordinates(split.domain) if unknowns.on_edge else np.empty_like(centre)

    def nets(faces: slice) -> Floats:
        pieces = Pieces(jets.own_forms(faces), centre[faces], share[faces], normals[faces])
        return powell_sabin_nets(degree, jets.order, pieces, unknowns.local_size)

    return unknowns.assembled(nets, _pattern(degree, jets.order, unknowns.local_size))


def _normal_coordinates(domain: GeodesicTriangulation) -> Floats:
    inverse = np.linalg.inv(np.swapaxes(domain.corners, 1, 2))
    normals = edge_normals(domain) @ np.swapaxes(inverse, 1, 2)
    return np.asarray(np.take_along_axis(normals, np.broadcast_to(_ROTATED, normals.shape), axis=2))


def _pattern(degree: int, order: int, unknowns: int) -> NDArray[np.bool_]:
    """Which forms may differ from zero: those that do on a triangle without any symmetry."""
    some = np.random.default_rng(0).uniform(0.5, 1.5, size=400)
    count = coefficient_count(order)
    pieces = Pieces(
        some[: 3 * count * count].reshape(1, 3, count, count),
        some[300:309].reshape(1, 3, 3),
        some[310:316].reshape(1, 3, 2),
        some[320:329].reshape(1, 3, 3),
    )
    return np.asarray((powell_sabin_nets(degree, order, pieces, unknowns) != 0)[0])


class PowellSabin2(PowellSabin):
    """C1 quadratic splines with three control points a vertex, not negative, with sum 1 (paper, 3.3).

    The functions of a vertex are the splines whose jet there is one Bernstein polynomial on a triangle on the tangent
    plane that holds the split points of its star, so they are not negative; in all three geometries the constant 1 has
    all coefficients 1 (Maes and Bultheel, 2007, for S^2).

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself.
    """

    polynomial_degree, jet_order, continuity = 2, 1, 1
    crease_unknowns = 3, 0, 0

    def _triangles(self, split: PowellSabinSplit) -> Floats:
        return enclosing_triangles(split.domain, split.around)

    def control_triangles(self, coefficients: Floats) -> Floats:
        """The three control points of every vertex, (V, 3, q), from the coefficients of q functions, (size, q).

        A surface touches the plane of the control points of a vertex there: its point is their convex combination with
        the coordinates of the vertex in `vertex_triangles` as weights.
        """
        return coefficients.reshape(self.domain.vertex_count, 3, -1)


class PowellSabin3(PowellSabin):
    """C1 cubic splines with six functions a vertex, C2 at the vertices and across the edges of the triangulation.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself.
    """

    polynomial_degree, jet_order, continuity = 3, 2, 1


class PowellSabin4(PowellSabin):
    """C1 quartic splines with six functions a vertex and one a triangle, C2 inside of the triangles.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself.
    """

    polynomial_degree, jet_order, continuity, in_face = 4, 2, 1, 1


class PowellSabin5(PowellSabin):
    """C2 quintic splines with ten functions a vertex and one a triangle, C3 at the vertices.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself.
    """

    polynomial_degree, jet_order, continuity, in_face = 5, 3, 2, 1


class PowellSabin6(PowellSabin):
    """C2 splines of degree 6 with ten functions a vertex and one an edge, C3 inside of the triangles.

    They contain the constants in all geometries.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself.
    """

    polynomial_degree, jet_order, continuity, on_edge = 6, 3, 2, 1
