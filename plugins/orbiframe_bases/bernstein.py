"""Bernstein polynomials on geodesic triangles: continuous piecewise polynomials of any degree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import Orbifold, Triangulation
from orbiframe.delaunay import domain_for
from orbiframe.splines import ElementBasis, along_reference, exponents
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_bases.degrees import require_degree

Ints = NDArray[np.intp]


class Bernstein(ElementBasis):
    """Continuous functions that are homogeneous polynomials of one degree on every geodesic triangle (paper, 3.2).

    A coefficient at a vertex or on an edge belongs to all triangles there, so the functions agree along edges; nothing
    more is asked of them. In S^2 and H^2 the constants are among them for even degree.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself; degree:
    at least 1.
    """

    def __init__(
        self,
        orbifold: Orbifold,
        triangulation: Triangulation | GeodesicTriangulation,
        *,
        size: int = 1000,
        degree: int = 4,
    ) -> None:
        require_degree("bernstein", degree, 1)
        domain = domain_for(orbifold, triangulation, size, (1, degree - 1, (degree - 1) * (degree - 2) // 2))
        number, count = shared_numbers(domain, degree)
        rows = number.size
        matrix = csr_array((np.ones(rows), number.ravel(), np.arange(rows + 1)), shape=(rows, count))
        super().__init__(domain, degree, domain.corners[:, None], matrix, 0)


def shared_numbers(domain: GeodesicTriangulation, degree: int) -> tuple[Ints, int]:
    """The unknown of every coefficient, (F, n), and how many there are: those on common edges are shared.

    First the vertices, then the edges, from the start of the reference halfedge on, then the insides of the triangles.
    """
    a = exponents(degree)
    number = np.empty((domain.face_count, len(a)), dtype=np.intp)
    inside = np.flatnonzero((a > 0).all(axis=1))
    base = domain.vertex_count + (degree - 1) * domain.edge_count
    number[:, inside] = base + np.arange(domain.face_count * len(inside)).reshape(domain.face_count, -1)
    edge, along = domain.edge.reshape(-1, 3), along_reference(domain).reshape(-1, 3)
    for c in range(3):
        after, opposite = (c + 1) % 3, (c + 2) % 3
        number[:, np.flatnonzero(a[:, c] == degree)[0]] = domain.vertex[:, c]
        for k in np.flatnonzero((a[:, opposite] == 0) & (a[:, c] > 0) & (a[:, after] > 0)):
            place = np.where(along[:, c], a[k, after], a[k, c]) - 1
            number[:, k] = domain.vertex_count + (degree - 1) * edge[:, c] + place
    return number, base + domain.face_count * len(inside)
