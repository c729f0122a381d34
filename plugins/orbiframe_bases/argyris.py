"""Argyris and Zenisek elements: C1 and C2 polynomials of high degree on whole triangles."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import Orbifold, Triangulation
from orbiframe.delaunay import domain_for
from orbiframe.splines import ElementBasis, Unknowns, VertexJets, along_reference, shaped_triangles
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_bases.degrees import require_degree
from orbiframe_bases.hermite import neighbours, normal_coordinates
from orbiframe_bases.unsplit import Corners, unknown_counts, unsplit_nets

Floats = NDArray[np.float64]


# Circumradius of the triangles of jets, in sizes of the star: where the mass matrix is conditioned best.
_RADIUS = 0.85


class Unsplit(ElementBasis):
    """C^r functions that are one polynomial on every triangle, with jets of order 2 r at the vertices (paper, 3.2).

    The unknowns are these jets, as Bernstein coefficients on a triangle on the tangent plane; blossoms with normals of
    the edges, as many as fix r derivatives across them; and free coefficients in the triangles. In S^2 and H^2 the
    constants are among the functions for even degree; for odd degree all are divided by the one that is nearest to 1.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself.
    """

    name: ClassVar[str]
    continuity: ClassVar[int]

    def __init__(
        self,
        orbifold: Orbifold,
        triangulation: Triangulation | GeodesicTriangulation,
        *,
        size: int = 1000,
        degree: int,
    ) -> None:
        least = 4 * self.continuity + 1
        require_degree(self.name, degree, least)
        counts = unknown_counts(degree, self.continuity)
        domain = domain_for(orbifold, triangulation, size, counts)
        matrix = _matrix(degree, self.continuity, Unknowns(domain, *counts))
        super().__init__(domain, degree, domain.corners[:, None], matrix, self.continuity)


class Argyris(Unsplit):
    """C1 polynomials of degree 5 or more on whole triangles, C2 at the vertices: 6 V + (2 d - 9) E + (d-4)(d-5)/2 F.

    The unknowns are 2-jets at the vertices, as Bernstein coefficients on a triangle on the tangent plane; d - 5 values
    and d - 4 slopes along every edge; and free coefficients in the triangles (Argyris, Fried and Scharpf, 1968). In S^2
    and H^2 the constants are among the functions for even degree; for odd degree all are divided by the one that is
    nearest to 1.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself; degree:
    at least 5.
    """

    name, continuity = "argyris", 1

    def __init__(
        self,
        orbifold: Orbifold,
        triangulation: Triangulation | GeodesicTriangulation,
        *,
        size: int = 1000,
        degree: int = 6,
    ) -> None:
        super().__init__(orbifold, triangulation, size=size, degree=degree)


class Zenisek(Unsplit):
    """C2 polynomials of degree 9 or more on whole triangles, C4 at the vertices: 15 V + (3 d - 24) E + (d-7)(d-8)/2 F.

    The unknowns are 4-jets at the vertices, as Bernstein coefficients on a triangle on the tangent plane; d - 9 values,
    d - 8 slopes and d - 7 second derivatives along every edge; and free coefficients in the triangles (Zenisek, 1970).
    In S^2 and H^2 the constants are among the functions for even degree; for odd degree all are divided by the one that
    is nearest to 1.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself; degree:
    at least 9.
    """

    name, continuity = "zenisek", 2

    def __init__(
        self,
        orbifold: Orbifold,
        triangulation: Triangulation | GeodesicTriangulation,
        *,
        size: int = 1000,
        degree: int = 9,
    ) -> None:
        super().__init__(orbifold, triangulation, size=size, degree=degree)


def _matrix(degree: int, smoothness: int, unknowns: Unknowns) -> csr_array:
    domain = unknowns.domain
    jets = VertexJets(domain, 2 * smoothness, shaped_triangles(domain, neighbours(domain), _RADIUS))
    normals, along = normal_coordinates(domain), along_reference(domain).reshape(-1, 3)

    def nets(faces: slice) -> Floats:
        corners = Corners(jets.own_forms(faces), normals[faces], along[faces])
        return unsplit_nets(degree, smoothness, corners, unknowns)[:, None]

    return unknowns.assembled(nets, _pattern(degree, smoothness, unknowns))


def _pattern(degree: int, smoothness: int, unknowns: Unknowns) -> NDArray[np.bool_]:
    """Which forms may differ from zero: those that do on two triangles without symmetry, their edges run either way."""
    rng, count = np.random.default_rng(0), unknowns.at_vertex
    some = Corners(
        rng.uniform(0.5, 1.5, (2, 3, count, count)),
        rng.uniform(0.5, 1.5, (2, 3, 3)),
        np.array([[True] * 3, [False] * 3]),
    )
    return np.asarray((unsplit_nets(degree, smoothness, some, unknowns) != 0).any(axis=0))[None]
