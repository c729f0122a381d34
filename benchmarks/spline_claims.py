"""What splines promise, measured on small triangulations: dimensions, jumps, reproduction."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe import Registry
from orbiframe.splines import ElementBasis
from orbiframe.triangulations import GeodesicTriangulation

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import element_checks
import simplex_checks
import spline_checks

Floats = NDArray[np.float64]


class Promise(NamedTuple):
    """A family, its options, how many functions a vertex, an edge and a triangle have, and how they are written."""

    name: str
    options: dict[str, Any]
    counts: tuple[int, int, int]

    @property
    def title(self) -> str:
        """The name, with the degree if it is an option."""
        return self.name + (f", degree {self.options['degree']}" if self.options else "")

    @property
    def formula(self) -> str:
        """The dimension."""
        parts = [f"{'' if n == 1 else n}{letter}" for n, letter in zip(self.counts, "VEF", strict=True) if n]
        return " + ".join(parts)

    def dimension(self, domain: GeodesicTriangulation) -> int:
        """The number of functions by the formula."""
        vertex, edge, face = self.counts
        return vertex * domain.vertex_count + edge * domain.edge_count + face * domain.face_count


PROMISES = [
    Promise("bernstein", {"degree": 2}, (1, 1, 0)),
    Promise("bernstein", {"degree": 3}, (1, 2, 1)),
    Promise("bernstein", {"degree": 4}, (1, 3, 3)),
    Promise("ps2", {}, (3, 0, 0)),
    Promise("ps3", {}, (6, 0, 0)),
    Promise("ps4", {}, (6, 0, 1)),
    Promise("ps5", {}, (10, 0, 1)),
    Promise("ps6", {}, (10, 1, 0)),
    Promise("clough-tocher", {}, (3, 1, 0)),
    Promise("argyris", {"degree": 5}, (6, 1, 0)),
    Promise("argyris", {"degree": 6}, (6, 3, 1)),
    Promise("zenisek", {}, (15, 3, 1)),
]


def show_claims(registry: Registry) -> None:
    """Print the tables."""
    domains = spline_checks.domains()
    print("| basis | dimension | rank | smooth | largest jump, orders 0 to r | least jump, order r + 1 | polynomials |")
    print("|---|---|---|---|---|---|---|")
    for promise in PROMISES:
        print(_row(promise, registry, domains), flush=True)
    print("\n| basis | smooth | order r, or largest jump | order r + 1, or jump |\n|---|---|---|---|")
    hybrid = registry.load("basis", "hybrid")
    made = [hybrid(d.orbifold, d) for d in domains.values()]
    low = max(element_checks.jumps_of_jets(b, b.domain, k) for b in made for k in (0, 1))
    high = min(element_checks.jumps_of_jets(b, b.domain, 2) for b in made)
    print(f"| hybrid, jumps | C1 | {low:.0e} | {high:.1g} |", flush=True)
    for name in ("simplex", "dms"):
        for degree in (2, 3):
            d = domains["Bolza"]
            basis = registry.load("basis", name)(d.orbifold, d, degree=degree)
            smooth, rough = (simplex_checks.jump(basis, order) for order in (degree - 1, degree))
            print(f"| {name}, degree {degree}, changes | C{degree - 1} | {smooth:.0e} | {rough:.1g} |", flush=True)


def _row(promise: Promise, registry: Registry, domains: dict[str, GeodesicTriangulation]) -> str:
    component = registry.load("basis", promise.name)
    bases = {name: component(d.orbifold, d, **promise.options) for name, d in domains.items()}
    for name, basis in bases.items():
        if basis.size != promise.dimension(basis.domain):
            raise ValueError(f"{promise.title} has {basis.size} functions on {name}; {promise.formula} says otherwise")
    smooth, rough = _jumps(list(bases.values()))
    degree = next(iter(bases.values())).degree
    residual = element_checks.residual_on_the_sphere(bases["sphere"], degree)
    rank = "full" if all(_independent(basis) for basis in bases.values()) else "less"
    numbers = f"C{int(bases['sphere'].smoothness)} | {smooth:.0e} | {rough:.2g} | {residual:.0e}"
    return f"| {promise.title} | {promise.formula} | {rank} | {numbers} |"


def _jumps(bases: list[ElementBasis]) -> tuple[float, float]:
    """The largest jump of orders up to the smoothness, and the least of the next one, over the surfaces."""
    low, high = [], []
    for basis in bases:
        coefficients, smooth = spline_checks.random_coefficients(basis), int(basis.smoothness)
        low += [spline_checks.jumps(basis, coefficients, order) for order in range(smooth + 1)]
        high.append(spline_checks.jumps(basis, coefficients, smooth + 1))
    return max(low), min(high)


def _independent(basis: ElementBasis) -> bool:
    matrix = basis.matrix.toarray()
    values = np.linalg.svd(matrix / np.linalg.norm(matrix, axis=0), compute_uv=False)
    return bool(values[-1] > 1e-10 * values[0])
