"""Claims of speed about splines, beside SciPy's interpolators in the plane."""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np
from claim import Action, Claim
from spline_speed import _AGAIN, _COUNT, _VERTICES, peers
from splines import problem

from orbiframe import Points, Registry, Triangulation
from orbiframe.delaunay import domain_for

_PAGE = "[splines](splines.md)"
_PER_VERTEX = {"ps2": 3, "ps5": 12, "clough-tocher": 6, "simplex2": 1, "simplex3": 2, "dms2": 4, "dms3": 9}


@cache
def torus() -> Triangulation:
    """The map of a torus."""
    return problem("torus", Registry.discover(), 4).triangulation


@cache
def points() -> Points:
    """Random points of it, in random order."""
    rng, made = np.random.default_rng(0), torus()
    return made.locate(rng.integers(made.polyhedron.face_count, size=_COUNT), rng.dirichlet(np.ones(3), _COUNT))


def evaluation(name: str, options: dict[str, Any], peer: int) -> tuple[Action, Action]:
    """Four sums of a family at the points, and the same of scipy's."""
    size = _PER_VERTEX[name + str(options.get("degree", ""))] * _VERTICES
    basis = Registry.discover().load("basis", name)(torus().orbifold, torus(), size=size, **options)
    coefficients = np.random.default_rng(2).normal(size=(basis.size, 4))
    return lambda: basis.values(points(), coefficients), peers()[peer]


def building(name: str) -> tuple[Action, Action]:
    """A basis on 4,000 triangles that are there, and scipy's on as many."""
    made, domain = (
        Registry.discover().load("basis", name),
        domain_for(torus().orbifold, torus(), 3 * _VERTICES, (3, 0, 0)),
    )
    return lambda: made(domain.orbifold, domain), peers()[1]


def again() -> tuple[Action, Action]:
    """Points evaluated again by a matrix that is kept, and anew."""
    basis = Registry.discover().load("basis", "ps2")(torus().orbifold, torus(), size=3 * _VERTICES)
    some = Points(points().patch[:_AGAIN], points().x[:_AGAIN])
    matrix, coefficients = basis.design_matrix(some), np.random.default_rng(2).normal(size=(basis.size, 3))
    return lambda: matrix @ coefficients, lambda: basis.values(some, coefficients)


def _evaluated(name: str, peer: int, least: float, **options: int) -> Claim:
    title = f"`{name}`" + "".join(f", degree {degree}" for degree in options.values())
    beside = ("`CloughTocher2DInterpolator`", "", "`NdBSpline`, bicubic")[peer]
    return Claim(f"{title}: 200,000 points", beside, least, _PAGE, partial(evaluation, name, options, peer))


CLAIMS = (
    _evaluated("clough-tocher", 0, 5.0),
    _evaluated("ps2", 2, 0.6),
    _evaluated("ps5", 0, 1.5),
    _evaluated("simplex", 0, 0.2, degree=2),
    _evaluated("simplex", 0, 0.1, degree=3),
    _evaluated("dms", 0, 0.3, degree=2),
    _evaluated("dms", 0, 0.15, degree=3),
    Claim("building `ps2`", "`CloughTocher2DInterpolator`", 1 / 3, _PAGE, partial(building, "ps2")),
    Claim("building `clough-tocher`", "`CloughTocher2DInterpolator`", 1 / 3, _PAGE, partial(building, "clough-tocher")),
    Claim("16,000 points of `ps2` by a matrix that is kept", "evaluation anew", 2.0, _PAGE, again),
)
