"""The laws of a basis: functions on X/H, whatever they are made of."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array

from orbiframe.errors import GeometryError
from orbiframe.functions.basis import Basis, DifferentiableBasis
from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.testing.lab import Lab
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Component = Callable[[Orbifold, Triangulation], Basis]


def shape_and_values_fit(component: Component, lab: Lab) -> None:
    """The design matrix of n points is a sparse array by rows, (n, size), of finite numbers; so it is for no points."""
    for basis, triangulation in _bases(component, lab):
        points = _points(triangulation, lab, 30)
        for chosen in (points, Points(points.patch[:0], points.x[:0])):
            matrix = basis.design_matrix(chosen)
            assert isinstance(matrix, csr_array), f"a {type(matrix).__name__}, wanted is a csr_array"
            assert matrix.shape == (len(chosen.patch), basis.size), f"shape {matrix.shape}"
            assert np.isfinite(matrix.data).all(), "a value is not finite"


def each_point_depends_on_itself_alone(component: Component, lab: Lab) -> None:
    """The row of a point does not depend on which other points are asked for, or in which order."""
    for basis, triangulation in _bases(component, lab):
        points = _points(triangulation, lab, 40)
        chosen = lab.rng.permutation(40)[:25]
        some = basis.design_matrix(Points(points.patch[chosen], points.x[chosen]))
        _close(some, basis.design_matrix(points)[chosen], 1e-12)


def functions_are_invariant_under_the_group(component: Component, lab: Lab) -> None:
    """A point of X/H has the same values in the frame of every patch that sees it."""
    for basis, triangulation in _bases(component, lab):
        atlas, geometry = basis.orbifold.atlas, basis.orbifold.geometry
        points = _points(triangulation, lab, 30)
        here = basis.design_matrix(points)
        size = np.abs(atlas.isometry).max(axis=(1, 2))
        for t in np.argsort(size[1:], kind="stable")[:12] + 1:
            rows = np.flatnonzero(points.patch == atlas.head[t])
            moved = geometry.settle(geometry.act(atlas.isometry[t], points.x[rows]))
            there = basis.design_matrix(Points(np.full(len(rows), atlas.tail[t]), moved))
            _close(there, here[rows], 3e-10 * size[t] ** 2 * max(1.0, abs(here).max()))


def constants_are_in_the_span(component: Component, lab: Lab) -> None:
    """Some combination of the functions is 1 everywhere, so a surface moves with the data that it is fitted to."""
    for basis, triangulation in _bases(component, lab):
        matrix = basis.design_matrix(_points(triangulation, lab, 10 * basis.size)).toarray()
        ones = np.ones(len(matrix))
        # Columns of one size: the span is the same, and small functions are not taken for rounding.
        even = matrix / np.maximum(np.linalg.norm(matrix, axis=0), np.finfo(float).tiny)
        residual = even @ np.linalg.lstsq(even, ones, rcond=None)[0] - ones
        assert np.abs(residual).max() < 1e-8, f"the nearest function is off by {np.abs(residual).max():.3g}"


def derivatives_are_continuous(component: Component, lab: Lab) -> None:
    """Derivatives up to min(smoothness, 2) along geodesics have no jumps.

    The difference of order k + 1 over h^k tends to zero with the step h where the k-th derivative is continuous; a jump
    of the derivative stays as it is. Where a derivative changes within less than a step, the steps become finer once.
    """
    for basis, triangulation in _bases(component, lab):
        order = int(min(basis.smoothness, 2))
        coarse, fine = (_roughness(basis, triangulation, order, n) for n in (500, 4000))
        if fine >= 0.6 * coarse + 1e-9:
            coarse, fine = fine, _roughness(basis, triangulation, order, 32_000)
        assert fine < 0.6 * coarse + 1e-9, f"derivative {order} jumps by {fine:.3g} (at a coarse step {coarse:.3g})"


def jets_agree_with_differences(component: Component, lab: Lab) -> None:
    """The covariant derivatives of first and second order are those of the functions along geodesics.

    At all points for a C-infinity basis; for piecewise functions at three points in four at least, because differences
    mean nothing across an edge where a derivative jumps.
    """
    for basis, triangulation in _bases(component, lab):
        if isinstance(basis, DifferentiableBasis):
            points = _points(triangulation, lab, 20)
            jets = [matrix.toarray() for matrix in basis.jet_matrices(points, 2)]
            _close(jets[0], basis.design_matrix(points), 1e-14)
            scale = 1 / np.sqrt(np.abs(jets[3:]).max() + 1)
            share, step = (1.0, 1e-2) if basis.smoothness > 1000 else (0.75, 1e-3)
            for angle in (0.0, np.pi / 2, 0.7):
                _check_direction(basis, points, jets, angle, step * scale, share)


def same_input_gives_the_same_matrix(component: Component, lab: Lab) -> None:
    """Built twice from the same input, and asked twice for the same points, a basis gives the same bits."""
    for basis, triangulation in _bases(component, lab):
        points = _points(triangulation, lab, 30)
        again = component(triangulation.orbifold, triangulation)
        first = basis.design_matrix(points)
        for other in (basis.design_matrix(points), again.design_matrix(points)):
            for name in ("indptr", "indices", "data"):
                assert np.array_equal(getattr(first, name), getattr(other, name)), f"{name} differ"


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    shape_and_values_fit,
    each_point_depends_on_itself_alone,
    functions_are_invariant_under_the_group,
    constants_are_in_the_span,
    derivatives_are_continuous,
    jets_agree_with_differences,
    same_input_gives_the_same_matrix,
)


# ---- mutants --------------------------------------------------------------------------------------------------------


class _Altered(DifferentiableBasis):
    """A basis whose matrices are changed: change(matrix, points, kind), kind 0 for values, 1 to 5 for derivatives."""

    def __init__(self, basis: Basis, change: Callable[[csr_array, Points, int], csr_array]) -> None:
        self._basis, self._change = basis, change
        self.orbifold, self.size, self.smoothness = basis.orbifold, basis.size, basis.smoothness

    def design_matrix(self, points: Points) -> csr_array:
        return self._change(self._basis.design_matrix(points), points, 0)

    def jet_matrices(self, points: Points, order: int) -> list[csr_array]:
        assert isinstance(self._basis, DifferentiableBasis)
        matrices = self._basis.jet_matrices(points, order)
        return [self._change(matrix, points, kind) for kind, matrix in enumerate(matrices)]


def _altered(change: Callable[[csr_array, Points, int], csr_array]) -> Callable[[Component], Component]:
    return lambda component: lambda orbifold, triangulation: _Altered(component(orbifold, triangulation), change)


def _scaled(matrix: csr_array, factor: Any) -> csr_array:
    return csr_array(diags_array(np.broadcast_to(factor, matrix.shape[:1])) @ matrix)


def _restless(component: Component) -> Component:
    calls = count()
    return _altered(lambda matrix, _, __: _scaled(matrix, 1 + 1e-9 * next(calls)))(component)


MUTANTS: dict[str, Callable[[Component], Component]] = {
    "shape_and_values_fit": _altered(lambda matrix, _, __: csr_array(matrix[:, 1:])),
    "each_point_depends_on_itself_alone": _altered(lambda m, _, __: _scaled(m, 1 + 0.01 * np.arange(m.shape[0]))),
    "functions_are_invariant_under_the_group": _altered(lambda m, points, _: _scaled(m, 1 + 0.1 * points.x[:, 1])),
    "constants_are_in_the_span": _altered(lambda m, points, _: _scaled(m, 1 + 0.1 * np.sin(9 * points.x[:, 1]))),
    "derivatives_are_continuous": _altered(lambda m, p, _: _scaled(m, 1 + 0.1 * np.abs(np.sin(20 * p.x[:, 1])))),
    "jets_agree_with_differences": _altered(lambda matrix, _, kind: _scaled(matrix, 1.01 if kind == 4 else 1.0)),
    "same_input_gives_the_same_matrix": _restless,
}


# ---- things to try --------------------------------------------------------------------------------------------------


def _bases(component: Component, lab: Lab) -> Iterator[tuple[Basis, Triangulation]]:
    """The basis on every surface; one that says by a GeometryError that it does not exist there is left out."""
    made = 0
    for triangulation in lab.triangulations.values():
        try:
            basis = component(triangulation.orbifold, triangulation)
        except GeometryError:
            continue
        made += 1
        yield basis, triangulation
    assert made, "the basis exists on none of the surfaces"


def _points(triangulation: Triangulation, lab: Lab, size: int) -> Points:
    """Random points of random triangles."""
    face = lab.rng.integers(triangulation.polyhedron.face_count, size=size)
    return triangulation.locate(face, lab.rng.dirichlet(np.ones(3), size))


def _along(basis: Basis, points: Points, angle: float, steps: Floats) -> Floats:
    """Values (steps, n, size) at points moved along the geodesics that leave them at an angle to their frames."""
    geometry = basis.orbifold.geometry
    direction = geometry.frame(points.x) @ np.array([np.cos(angle), np.sin(angle)])
    moved = geometry.exp(points.x, steps[:, None, None] * direction)
    every = Points(np.tile(points.patch, len(steps)), moved.reshape(-1, 3))
    return basis.design_matrix(every).toarray().reshape(len(steps), len(points.patch), -1)


def _roughness(basis: Basis, triangulation: Triangulation, order: int, steps: int) -> float:
    """The largest difference of order k + 1 over h^k along a few geodesics as long as the surface is wide."""
    face = np.arange(0, triangulation.polyhedron.face_count, triangulation.polyhedron.face_count // 3 + 1)
    start = triangulation.locate(face, np.full((len(face), 3), 1 / 3))
    width = min(np.sqrt(basis.orbifold.area), 2.0)
    h = width / steps
    values = _along(basis, start, 0.4, h * np.arange(steps))
    return float(np.abs(np.diff(values, order + 1, axis=0)).max() / h**order)


def _check_direction(basis: Basis, points: Points, jets: list[Floats], angle: float, h: float, share: float) -> None:
    """Derivatives along one direction against differences of fourth order, at a share of the points."""
    c, s = np.cos(angle), np.sin(angle)
    below2, below, here, above, above2 = _along(basis, points, angle, h * np.arange(-2.0, 3.0))
    first = (8 * (above - below) - (above2 - below2)) / (12 * h)
    second = (16 * (above + below - 2 * here) - (above2 + below2 - 2 * here)) / (12 * h * h)
    bend = c * c * jets[3] + 2 * c * s * jets[4] + s * s * jets[5]
    _mostly_close(first, c * jets[1] + s * jets[2], 1e-5 * np.abs(jets[1:3]).max(), share)
    rounding = 1e-14 * np.abs(here).max() / h**2
    _mostly_close(second, bend, 1e-4 * np.abs(jets[3:]).max() + rounding, share)


def _mostly_close(found: Floats, wanted: Floats, tolerance: float, share: float) -> None:
    error = np.quantile(np.abs(found - wanted).max(axis=1), share, method="inverted_cdf")
    assert error <= tolerance, (
        f"off by {error:.3g} at more than {1 - share:.0%} of the points; allowed is {tolerance:.3g}"
    )


def _close(found: Any, wanted: Any, tolerance: float) -> None:
    error = np.abs(_dense(found) - _dense(wanted)).max(initial=0.0)
    assert error <= tolerance, f"off by {error:.3g}, allowed is {tolerance:.3g}"


def _dense(matrix: Any) -> Floats:
    return np.asarray(matrix.toarray() if isinstance(matrix, csr_array) else matrix)
