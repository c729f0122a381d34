"""Speed of splines on one core, beside SciPy's interpolators in the plane, all in one run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CloughTocher2DInterpolator, NdBSpline

from orbiframe import Points, Registry, Triangulation
from orbiframe.delaunay import domain_for
from orbiframe.functions.lifted_centres import LiftedCentres
from orbiframe.functions.orbit_sum import in_blocks
from orbiframe.triangulations import GeodesicTriangulation

Floats = NDArray[np.float64]

_COUNT = 200_000
_VERTICES = 2000
_ROUNDS, _RUNS = 4, 3
_AGAIN = 16_000
FAMILIES: list[tuple[str, dict[str, Any], int]] = [
    ("ps2", {}, 3),
    ("ps3", {}, 6),
    ("ps4", {}, 8),
    ("ps5", {}, 12),
    ("ps6", {}, 13),
    ("clough-tocher", {}, 6),
    ("simplex", {"degree": 2}, 1),
    ("simplex", {"degree": 3}, 2),
    ("dms", {"degree": 2}, 4),
    ("dms", {"degree": 3}, 9),
]


def show_speed(registry: Registry, made: Triangulation) -> None:
    """Print the tables: evaluation, building, a matrix that is kept, Gaussians."""
    rng = np.random.default_rng(0)
    face = rng.integers(made.polyhedron.face_count, size=_COUNT)
    points = made.locate(face, rng.dirichlet(np.ones(3), _COUNT))
    show_evaluation(registry, made, points)
    domain = domain_for(made.orbifold, made, 3 * _VERTICES, (3, 0, 0))
    show_building(registry, domain)
    basis = registry.load("basis", "ps2")(made.orbifold, domain)
    matrix = basis.design_matrix(Points(points.patch[:_AGAIN], points.x[:_AGAIN]))
    coefficients = rng.normal(size=(basis.size, 3))
    again = least([lambda: matrix @ coefficients])[0]
    print(f"\nA design matrix of ps2 evaluates {_AGAIN:,} points again in {1e3 * again:.2f} ms.")
    show_pairs(registry, made, points)


def least(works: list[Callable[[], object]]) -> list[float]:
    """The least processor time of each of several works, seconds; they take turns, so that all see the same load."""
    times = np.full(len(works), np.inf)
    for _ in range(_ROUNDS):
        for n, work in enumerate(works):
            for _ in range(_RUNS):
                start = time.process_time()
                work()
                times[n] = min(times[n], time.process_time() - start)
    return list(times)


def peers() -> tuple[Callable[[], object], Callable[[], object], Callable[[], object]]:
    """SciPy's Clough-Tocher splines evaluated and built, and its bicubic splines evaluated."""
    rng = np.random.default_rng(1)
    sites, heights, where = rng.random((_VERTICES, 2)), rng.normal(size=(_VERTICES, 4)), rng.random((_COUNT, 2))
    cubic = CloughTocher2DInterpolator(sites, heights)
    cubic(where[:10])
    knots = (np.arange(68) - 3) / 61
    product = NdBSpline((knots, knots), rng.normal(size=(64, 64, 4)), 3)
    return lambda: cubic(where), lambda: CloughTocher2DInterpolator(sites, heights), lambda: product(where)


def evaluations(
    registry: Registry, made: Triangulation, points: Points
) -> Iterator[tuple[str, int, Callable[[], object]]]:
    """A title, the number of functions, and what evaluates four of their sums at the points."""
    rng = np.random.default_rng(2)
    for name, options, per_vertex in FAMILIES:
        basis = registry.load("basis", name)(made.orbifold, made, size=per_vertex * _VERTICES, **options)
        coefficients = rng.normal(size=(basis.size, 4))
        basis.values(points, coefficients)
        title = name + (f", degree {options['degree']}" if options else "")
        yield title, basis.size, lambda basis=basis, c=coefficients: basis.values(points, c)


def show_evaluation(registry: Registry, made: Triangulation, points: Points) -> None:
    """Points a second in random order, four functions at once."""
    cubic, _, product = peers()
    print("| evaluation | million points a second | times CloughTocher2D | times NdBSpline |\n|---|---|---|---|")
    first = least([cubic, product])
    print(f"| scipy CloughTocher2DInterpolator, {_VERTICES:,} points | {_COUNT / first[0] / 1e6:.2f} | 1 | |")
    print(f"| scipy NdBSpline, bicubic, 64 x 64 | {_COUNT / first[1] / 1e6:.2f} | | 1 |")
    for title, size, work in evaluations(registry, made, points):
        spent, slow, fast = least([work, cubic, product])
        print(
            f"| {title}, {size:,} functions | {_COUNT / spent / 1e6:.2f} | {slow / spent:.2f} | {fast / spent:.2f} |",
            flush=True,
        )


def show_building(registry: Registry, domain: GeodesicTriangulation) -> None:
    """Seconds for a basis on a triangulation that is there."""
    build = peers()[1]
    print(f"\n| building on {domain.face_count:,} triangles | seconds | times scipy's | thousand triangles a second |")
    print("|---|---|---|---|")
    for name in ("ps2", "clough-tocher", "ps6"):
        component = registry.load("basis", name)
        spent, other = least([lambda component=component: component(domain.orbifold, domain), build])
        rate = domain.face_count / spent / 1e3
        print(f"| {name} | {spent:.3f} | {spent / other:.1f} | {rate:.0f} |", flush=True)


def show_pairs(registry: Registry, made: Triangulation, points: Points) -> None:
    """Pairs of a point and a Gaussian that reaches it, a second."""
    basis = registry.load("basis", "gaussian")(made.orbifold, made, size=1000)

    def search() -> int:
        return sum(
            in_blocks(
                LiftedCentres(made.orbifold, basis.centres, basis.support), points, lambda pairs: len(pairs.column)
            )
        )

    pairs, spent = search(), least([search])[0]
    rate, share = pairs / spent / 1e6, pairs / _COUNT
    print(f"Gaussians: {rate:.0f} million accepted pairs a second, {share:.0f} at a point.")
