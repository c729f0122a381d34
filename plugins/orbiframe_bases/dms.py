"""DMS splines on X/H: as smooth as their degree allows, over any triangulation."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError, Orbifold, Triangulation, UsageError
from orbiframe.delaunay import domain_for
from orbiframe.splines import exponents
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe_bases.bernstein import shared_numbers
from orbiframe_bases.degrees import require_degree
from orbiframe_bases.knot_clouds import flatness, knot_clouds
from orbiframe_bases.simplex_program import cloud_program
from orbiframe_bases.simplex_splines import KnotSets, SimplexSplines

# Knots by the hundred round every triangle: time grows like the fourth power.
MOST_DEGREE = 10

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_TURNS = np.arange(12) * (2 * np.pi / 12)


class DMS(SimplexSplines):
    """The splines of Dahmen, Micchelli and Seidel, homogeneous: C^(degree - 1) on every X/H (paper, section 3.3).

    Every vertex v has a cloud of knots t_0 = v, t_1, ..., t_degree, moved along by the group. Function beta of a
    triangle, b1 + b2 + b3 = degree, is |det(t_(1,b1), t_(2,b2), t_(3,b3))| times the simplex spline with the knots
    t_(i,0), ..., t_(i,b_i) of every corner i. A homogeneous polynomial has its blossom at the knots
    t_(i,0), ..., t_(i,b_i - 1) as coefficients.

    triangulation: the map of a mesh, on which a domain for about `size` functions is made, or a domain itself; degree:
    at least 1; condensed: functions with the same blossom arguments are added up, which leaves as many as continuous
    polynomials of that degree have; False keeps all; radius: of the clouds, in shortest edges at the vertex, up to 0.3.

    Raises UsageError for an option out of range, FitError for triangles that the clouds turn over.
    """

    def __init__(
        self,
        orbifold: Orbifold,
        triangulation: Triangulation | GeodesicTriangulation,
        *,
        size: int = 1000,
        degree: int = 3,
        condensed: bool = True,
        radius: float = 0.2,
    ) -> None:
        require_degree("dms", degree, 1, MOST_DEGREE)
        if not 0 < radius <= 0.3:
            raise UsageError(f"dms has the radius {radius}; it must be positive and at most 0.3")
        count = (degree + 1) * (degree + 2) // 2
        inside = (degree - 1) * (degree - 2) // 2
        unknowns = (1, degree - 1, inside) if condensed else (0, 0, count)
        domain = domain_for(orbifold, triangulation, size, unknowns)
        clouds = corner_clouds(domain, degree, radius)
        if condensed:
            column, size = shared_numbers(domain, degree)
        else:
            size = domain.face_count * count
            column = np.arange(size).reshape(-1, count)
        a = exponents(degree)
        factor = np.abs(np.linalg.det(np.stack([clouds[:, i, a[:, i]] for i in range(3)], axis=2)))
        face = np.arange(domain.face_count)
        knots = clouds.reshape(len(face), -1, 3)
        none = np.zeros((0, 0, 3))
        super().__init__(domain, degree, KnotSets(cloud_program(degree), face, knots, factor, none, column, size))


def corner_clouds(domain: GeodesicTriangulation, degree: int, radius: float) -> Floats:
    """The clouds of the corners in the frame of every triangle, (F, 3, degree + 1, 3).

    Of a few turns of all clouds, the one that keeps three knots of a spline farthest from a line: splines with knots
    almost in line have creases. Raises FitError if three knots, one of each cloud, run clockwise.
    """
    program = cloud_program(degree)
    triples = sorted({t for o in program.outputs for t in combinations(program.states[o], 3)})
    tries = [_corner_clouds(domain, degree, radius, turn) for turn in _TURNS]
    flat = [flatness(clouds.reshape(domain.face_count, -1, 3), np.array(triples)) for clouds in tries]
    clouds = tries[int(np.argmax(flat))]
    p, q, r = (np.expand_dims(clouds[:, i], [1 + k for k in range(3) if k != i]) for i in range(3))
    turned = (np.einsum("...i,...i->...", p, np.cross(q, r)) <= 0).any(axis=(1, 2, 3))
    if turned.any():
        raise FitError(
            f"the knots of {turned.sum()} triangles turn over, the first is triangle {turned.argmax()}; lower the "
            "option radius or take a triangulation with less flat triangles"
        )
    return clouds


def _corner_clouds(domain: GeodesicTriangulation, degree: int, radius: float, turn: float) -> Floats:
    clouds = knot_clouds(domain, degree, radius, turn)[domain.vertex]
    return np.asarray(np.einsum("fcij,fckj->fcki", domain.corner_frame, clouds))
