"""Clough-Tocher splines: C1 cubics on the split of every triangle in three."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import Orbifold, Triangulation
from orbiframe.delaunay import domain_for
from orbiframe.splines import ElementBasis
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_bases.hermite import CubicHermite

Floats = NDArray[np.float64]

_NEXT = np.array([1, 2, 0])


class CloughTocher(ElementBasis):
    """C1 cubic splines on the split of every triangle in three, with a gradient at every vertex and one at every edge.

    The unknowns are first jets at the vertices, as Bernstein coefficients on a triangle on the tangent plane, and the
    blossom B(v_i, v_j, n) with the normal n of every edge (Clough and Tocher, 1965; homogeneous as in section 3.2 of
    the paper). In S^2 and H^2 the functions are divided by the one that has the data of 1.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself.
    """

    crease_unknowns = 3, 1, 0

    def __init__(
        self, orbifold: Orbifold, triangulation: Triangulation | GeodesicTriangulation, *, size: int = 1000
    ) -> None:
        domain = domain_for(orbifold, triangulation, size, (3, 1, 0), creases=True)
        data = CubicHermite(domain)

        def nets(faces: slice) -> Floats:
            return clough_tocher_nets(*data.forms(faces))

        corner = np.zeros((3, 3, 12), dtype=np.bool_)
        for c in range(3):
            corner[c, :, data.unknowns.vertex_slots(c)] = True
        pattern = clough_tocher_nets(corner[None].astype(float), data.pattern[None].astype(float))[0] != 0
        super().__init__(domain, 3, _micro_triangles(domain), data.unknowns.assembled(nets, pattern), 1, rational=False)
        if domain.geometry.curvature:
            self.weights = data.one


def _micro_triangles(domain: GeodesicTriangulation) -> Floats:
    """Micro triangle e is (v_e, v_(e + 1), Z) with Z = (v_1 + v_2 + v_3) / 3, (F, 3, 3, 3)."""
    x = domain.corners
    centre = np.broadcast_to(x.mean(axis=1, keepdims=True), x.shape)
    return np.stack([x, x[:, _NEXT], centre], axis=2)


def clough_tocher_nets(corner: Floats, wanted: Floats) -> Floats:
    """The ten coefficients on each of three micro triangles, (N, 3, 10, m), from cubic Hermite data.

    corner: (N, 3, 3, m), B(v_c, v_c, v_(c + m)); wanted: (N, 3, m), B(v_1, v_2, v_3) as each edge wants it, which
    gives B(v_i, v_j, Z). The rest follows from Z = (v_1 + v_2 + v_3) / 3 and C1 across the inner edges.
    """
    to_next, to_last = corner[:, :, 1], corner[:, :, 2]
    to_centre = corner.mean(axis=2)
    across = (to_next + to_last[:, _NEXT] + wanted) / 3
    middle = (to_centre + across + np.roll(across, 1, axis=1)) / 3
    centre = np.broadcast_to(middle.mean(axis=1, keepdims=True), middle.shape)
    start = (corner[:, :, 0], to_next, to_centre, to_last[:, _NEXT], across, middle)
    end = (corner[:, _NEXT, 0], to_centre[:, _NEXT], middle[:, _NEXT], centre)
    return np.stack(start + end, axis=2)
