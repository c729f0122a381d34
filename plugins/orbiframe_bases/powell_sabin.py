"""Powell-Sabin splines: smooth piecewise polynomials on the split of every triangle in six."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import (
    ElementBasis,
    GeodesicTriangulation,
    Orbifold,
    PowellSabinSplit,
    Triangulation,
    Unknowns,
    VertexJets,
    domain_for,
    enclosing_triangles,
)

Floats = NDArray[np.float64]


class PowellSabin2(ElementBasis):
    """C1 quadratic splines with three control points a vertex, not negative, with sum 1 (paper, 3.3).

    The Powell-Sabin split of a triangulation of X/H through the incentres. The functions of a vertex are the splines
    whose jet there is one Bernstein polynomial on a triangle on the tangent plane that holds the split points of its
    star, so they are not negative; in all three geometries the constant 1 has all coefficients 1 (Maes and Bultheel,
    2007, for S^2).

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself.
    """

    def __init__(
        self, orbifold: Orbifold, triangulation: Triangulation | GeodesicTriangulation, *, size: int = 1000
    ) -> None:
        domain = domain_for(orbifold, triangulation, size, (3, 0, 0))
        split = PowellSabinSplit(domain)
        jets = VertexJets(domain, 1, enclosing_triangles(domain, split.around))
        unknowns = Unknowns(domain, 3, 0, 0)
        super().__init__(domain, 2, split.cells, unknowns.matrix(_nets(split, jets, unknowns)), 1)


def _nets(split: PowellSabinSplit, jets: VertexJets, unknowns: Unknowns) -> Floats:
    """The Bernstein coefficients as forms of the nine unknowns of a triangle, (F, 6, 6, 9).

    B(v, u) is the jet of the corner; at R it is linear between the two ends of its edge, at Z between three corners.
    """
    domain = split.domain
    faces, z = domain.face_count, split.coordinates(split.incentre)

    def at_corner(corner: int, vectors: Floats) -> Floats:
        """B(v_corner, u) for u in the columns of (F, 3, 3), as forms: (F, 3, 9)."""
        form = np.zeros((faces, 3, unknowns.local_size))
        form[:, :, unknowns.vertex_slots(corner)] = jets.forms(corner, vectors)
        return form

    corner_z = np.zeros((faces, 3, unknowns.local_size))
    nets = np.empty((faces, 6, 6, unknowns.local_size))
    for cell in range(6):
        edge, corner = cell // 2, (cell // 2 + cell % 2) % 3
        at = at_corner(corner, np.swapaxes(split.cells[:, cell], 1, 2))
        corner_z[:, corner] = at[:, 2]
        nets[:, cell, 0], nets[:, cell, 1], nets[:, cell, 2] = at[:, 0], at[:, 1], at[:, 2]
    at_centre = np.einsum("fc,fcu->fu", z, corner_z)
    for edge in range(3):
        mu, nu = split.share[:, edge, 0, None], split.share[:, edge, 1, None]
        for cell in (2 * edge, 2 * edge + 1):
            nets[:, cell, 3] = mu * nets[:, 2 * edge, 1] + nu * nets[:, 2 * edge + 1, 1]
            nets[:, cell, 4] = mu * corner_z[:, edge] + nu * corner_z[:, (edge + 1) % 3]
            nets[:, cell, 5] = at_centre
    return nets
