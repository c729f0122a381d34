"""The laws of a fitter, tried on bumps about some vertices."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.basis import Basis
from orbiframe.functions.fitter import Fitter, ValidatedFitter
from orbiframe.functions.orbit_sum_basis import OrbitSumBasis
from orbiframe.functions.samples import Samples
from orbiframe.orbifolds.atlas import Points
from orbiframe.testing.lab import Lab, Untried
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Component = Callable[[], Fitter]

_SIZE = 20
_COUNT = 400


def constants_are_reproduced(component: Component, lab: Lab) -> None:
    """Constant data in a space that contains the constants gives that constant, however strongly a fitter smooths."""
    for case in _cases(lab):
        fitted = case.matrix @ component().fit(case.basis, case.with_values(np.full((_COUNT, 2), 3.0)))
        assert np.abs(fitted - 3).max() < 1e-6, f"3 becomes {fitted.flat[np.abs(fitted - 3).argmax()]}"


def smooth_data_in_the_span_is_nearly_reproduced(component: Component, lab: Lab) -> None:
    """A slowly varying function of the space is found again within a tenth of its variation."""
    for case in _cases(lab):
        values = case.matrix @ case.slow
        error = case.matrix @ component().fit(case.basis, case.with_values(values)) - values
        spread, wanted = np.std(error, axis=0), np.std(values, axis=0)
        assert (spread < 0.1 * wanted).all(), f"errors {spread}, the data vary by {wanted}"


def result_is_linear_in_the_values(component: Component, lab: Lab) -> None:
    """The fit of a combination of data is the combination of the fits, and columns do not mix.

    A fitter that finds its fairing from the data is taken with the fairing that it finds first; one that does not claim
    to be linear is not tried.
    """
    if not component().linear:
        raise Untried("it does not claim to be linear (Fitter.linear)")
    for case in _cases(lab):
        u, v = lab.rng.normal(size=(2, _COUNT, 2))
        component = _settled(component, case, u)
        first, second = (component().fit(case.basis, case.with_values(w)) for w in (u, v))
        _same_function(case, component().fit(case.basis, case.with_values(2 * u - 3 * v)), 2 * first - 3 * second)
        alone = component().fit(case.basis, case.with_values(u[:, 1:]))
        _same_function(case, alone, first[:, 1:])


def _settled(component: Component, case: _Case, values: Floats) -> Component:
    """A fitter whose fairing does not depend on the data."""
    fitter = component()
    if not isinstance(fitter, ValidatedFitter):
        return component
    return partial(type(fitter), fairing=fitter.fit_validated(case.basis, case.with_values(values)).fairing)


def unit_and_zero_of_the_values_do_not_matter(component: Component, lab: Lab) -> None:
    """The fit of three times the data plus two is three times the fit plus two, of a fitter that is not linear too."""
    for case in _cases(lab):
        v = lab.rng.normal(size=(_COUNT, 2))
        found = case.matrix @ component().fit(case.basis, case.with_values(3 * v + 2))
        wanted = 3 * (case.matrix @ component().fit(case.basis, case.with_values(v))) + 2
        error = np.abs(found - wanted).max()
        assert error <= 1e-5 * np.abs(wanted).max(), f"the functions differ by {error:.3g}"


def weights_matter(component: Component, lab: Lab) -> None:
    """Of two values at the same points, the one with the larger weight has more influence."""
    for case in _cases(lab):
        twice = np.concatenate([np.arange(_COUNT), np.arange(_COUNT)])
        both = case.with_values(np.ones((_COUNT, 1))).take(twice)
        values = np.repeat([0.0, 1.0], _COUNT)[:, None]
        for heavy in (0, 1):
            weights = both.weights * np.where(values[:, 0] == heavy, 3.0, 1.0)
            data = Samples(both.points, values, weights, both.stretch)
            mean = np.mean(case.matrix @ component().fit(case.basis, data))
            assert abs(mean - heavy) < 0.4, f"weights 3 to 1 for {heavy}, the mean is {mean:.3g}"


def unit_of_the_weights_does_not_matter(component: Component, lab: Lab) -> None:
    """Seven times the weights give the same fit."""
    for case in _cases(lab):
        data = case.with_values(lab.rng.normal(size=(_COUNT, 2)))
        seven = Samples(data.points, data.values, 7 * data.weights, data.stretch)
        _same_function(case, component().fit(case.basis, seven), component().fit(case.basis, data))


def order_of_samples_does_not_matter(component: Component, lab: Lab) -> None:
    """The same samples in another order give the same fit."""
    for case in _cases(lab):
        data = case.with_values(lab.rng.normal(size=(_COUNT, 2)))
        shuffled = data.take(lab.rng.permutation(_COUNT))
        _same_function(case, component().fit(case.basis, shuffled), component().fit(case.basis, data))


def fit_is_pure(component: Component, lab: Lab) -> None:
    """Asked twice it gives the same bits, (size, d), and leaves the samples as they were."""
    for case in _cases(lab):
        data = case.with_values(lab.rng.normal(size=(_COUNT, 2)))
        kept = data.take(np.arange(_COUNT))
        fitter = component()
        first, again = (fitter.fit(case.basis, data) for _ in range(2))
        assert np.shape(first) == (case.basis.size, 2), f"shape {np.shape(first)}"
        assert np.array_equal(first, again), "the second answer differs"
        for name in ("values", "weights", "stretch"):
            assert np.array_equal(getattr(data, name), getattr(kept, name)), f"{name} were changed"


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    constants_are_reproduced,
    smooth_data_in_the_span_is_nearly_reproduced,
    result_is_linear_in_the_values,
    unit_and_zero_of_the_values_do_not_matter,
    weights_matter,
    unit_of_the_weights_does_not_matter,
    order_of_samples_does_not_matter,
    fit_is_pure,
)


# ---- mutants --------------------------------------------------------------------------------------------------------


class _Altered(Fitter):
    """A fitter that sees changed samples and whose coefficients are changed by `after(coefficients, samples)`."""

    def __init__(
        self, fitter: Fitter, before: Callable[[Samples], Samples], after: Callable[[Floats, Samples], Floats]
    ) -> None:
        self._fitter, self._before, self._after = fitter, before, after

    def fit(self, basis: Basis, samples: Samples) -> Floats:
        return self._after(self._fitter.fit(basis, self._before(samples)), samples)


def _altered(
    before: Callable[[Samples], Samples] = lambda samples: samples,
    after: Callable[[Floats, Samples], Floats] = lambda coefficients, _: coefficients,
) -> Callable[[Component], Component]:
    return lambda component: lambda: _Altered(component(), before, after)


def _with_weights(samples: Samples, weights: Floats) -> Samples:
    return Samples(samples.points, samples.values, weights, samples.stretch)


def _spoilt(samples: Samples) -> Samples:
    """The samples themselves, after a change in place."""
    samples.values[0] += 1
    return samples


MUTANTS: dict[str, Callable[[Component], Component]] = {
    "constants_are_reproduced": _altered(after=lambda c, _: 0.99 * c),
    "smooth_data_in_the_span_is_nearly_reproduced": _altered(after=lambda c, _: np.mean(c, axis=0) + 0 * c),
    "result_is_linear_in_the_values": _altered(after=lambda c, samples: c + 0.01 * np.abs(samples.values).max()),
    "unit_and_zero_of_the_values_do_not_matter": _altered(after=lambda c, _: np.round(c, 1)),
    "weights_matter": _altered(before=lambda s: _with_weights(s, np.ones_like(s.weights))),
    "unit_of_the_weights_does_not_matter": _altered(after=lambda c, s: c * (1 + 0.01 * s.weights.mean())),
    "order_of_samples_does_not_matter": _altered(before=lambda s: s.take(np.arange(len(s.weights) // 2))),
    "fit_is_pure": _altered(before=_spoilt),
}


# ---- things to try --------------------------------------------------------------------------------------------------


class _Bumps(OrbitSumBasis):
    """The profile (1 - t)^6 about some vertices; five continuous derivatives."""

    smoothness = 5

    def profile(self, t: Floats) -> tuple[Floats, Floats, Floats]:
        rest = np.maximum(1 - t, 0.0)
        return rest**6, -6 * rest**5, 30 * rest**4


class _Case(NamedTuple):
    """A space of bumps, its matrix at the sample points, slowly varying coefficients, and samples without values."""

    basis: Basis
    matrix: Floats
    slow: Floats
    points: Points
    weights: Floats
    stretch: Floats

    def with_values(self, values: Floats) -> Samples:
        return Samples(self.points, np.array(values), self.weights, self.stretch)


def _cases(lab: Lab) -> Iterator[_Case]:
    for triangulation in lab.triangulations.values():
        yield _case(triangulation, lab)


def _case(triangulation: Triangulation, lab: Lab) -> _Case:
    face = lab.rng.integers(triangulation.polyhedron.face_count, size=_COUNT)
    points = triangulation.locate(face, lab.rng.dirichlet(np.ones(3), _COUNT))
    basis = _bumps(triangulation, lab)
    weights, stretch = lab.rng.uniform(1, 2, _COUNT), np.ones(_COUNT)
    wide = _Bumps(basis.orbifold, basis.centres, 8 * basis.support).design_matrix(basis.centres)
    slow = np.asarray(wide @ (wide @ lab.rng.normal(size=(basis.size, 2))))
    return _Case(basis, basis.design_matrix(points).toarray(), slow, points, weights, stretch)


def _bumps(triangulation: Triangulation, lab: Lab) -> OrbitSumBasis:
    """Bumps about random vertices, each on a disc of 25 times the area that it has to itself."""
    count = min(_SIZE, len(triangulation.points))
    chosen = np.sort(lab.rng.permutation(len(triangulation.points))[:count])
    centres = Points(triangulation.patch[chosen], triangulation.points[chosen])
    support = 4 * triangulation.orbifold.area / count
    return _Bumps(triangulation.orbifold, centres, np.full(count, support))


def _same_function(case: _Case, found: Floats, wanted: Floats) -> None:
    error = np.abs(case.matrix @ (found - wanted)).max()
    size = np.abs(case.matrix @ wanted).max()
    assert error <= 1e-6 * size, f"the functions differ by {error:.3g}, their size is {size:.3g}"
