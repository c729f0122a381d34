"""Smoothing system: the equations of smoothing splines, for any fairing and any trust in the data."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array

from orbiframe import Basis, DifferentiableBasis, FitError, Samples
from orbiframe_fitters.chunks import chunks
from orbiframe_fitters.conditions import Conditions, conditions_of
from orbiframe_fitters.energy import energy_of
from orbiframe_fitters.gram import Gram
from orbiframe_fitters.posterior import Posterior

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# What is tried: powers of ten, and between them where it matters.
_LADDER = 10.0 ** np.arange(-9, 4)
_STEPS = 10.0 ** np.array([-0.5, 0.5])
# So many data are left out in turn while fairing is looked for.
_TRIED = 1000


class Fit(NamedTuple):
    """Coefficients (size, d) with their posterior, and what some samples tell of it.

    leverage: (k,), how many numbers the fit takes from each of them; left_out: (k, d), what their values are beyond the
    fit of all others; growth: (k,), by how much the variance of that exceeds the variance of the datum; weights: (k,).
    """

    coefficients: Floats
    posterior: Posterior
    leverage: Floats
    left_out: Floats
    growth: Floats
    weights: Floats

    @property
    def sizes(self) -> Floats:
        """How large the errors (k, d) are, each by its own variance and in the unit of the values."""
        return np.asarray(self.left_out / np.sqrt(self.growth)[:, None])

    @property
    def noise(self) -> Floats:
        """The standard deviation of a datum of weight 1, (d,)."""
        return np.asarray(np.sqrt(np.mean(self.weights[:, None] * self.sizes**2, axis=0)))


class SmoothingSystem(NamedTuple):
    """Conditions that are nearly met, with weights (m,), and those that are met exactly; Gram matrices of the nearly
    met ones, of the energy, and of the exact ones.
    """

    soft: Conditions
    weights: Floats
    exact: Conditions
    gram: Any
    stiff: Any
    fixed: Any

    @classmethod
    def of(cls, basis: Basis, samples: Samples, *, interpolate: bool = False) -> SmoothingSystem:
        """That of samples. Data are those with weight; all are met exactly if so wanted, else the fixed ones."""
        counted, fair = np.flatnonzero(samples.weights > 0), samples.take(np.flatnonzero(samples.shares > 0))
        if not len(counted):
            raise FitError("all samples have weight zero; at least one must count")
        conditions = conditions_of(basis, samples, counted)
        fixed = np.zeros(len(samples.weights), dtype=np.bool_) if samples.fixed is None else samples.fixed
        met = interpolate | fixed[conditions.sample]
        exact, soft = conditions.take(np.flatnonzero(met)), conditions.take(np.flatnonzero(~met))
        # A slope counts like the difference of values that it makes from function to function.
        length = np.where(soft.kind > 0, basis.orbifold.area / basis.size, 1.0)
        weights = samples.weights[soft.sample] * length
        matrices = [_gram(basis.size, each, w) for each, w in ((soft, weights), (exact, np.ones(len(exact.sample))))]
        return cls(soft, weights, exact, matrices[0], _stiffness(basis, fair), matrices[1])

    def trusting(self, trust: Floats) -> SmoothingSystem:
        """With the weights of the nearly met conditions times (m,)."""
        weights = self.weights * trust
        return self._replace(weights=weights, gram=_gram(self.stiff.shape[0], self.soft, weights))

    def fit(self, fairing: float, drawn: Ints) -> Fit:
        """The fit, and what some of the samples are beyond it without them, their values and slopes at once."""
        matrix, right = self.gram + fairing * self.stiff, self.soft.rows.T @ (self.weights[:, None] * self.soft.values)
        if not len(self.exact.sample):
            posterior = Posterior(matrix)
            return self._tested(posterior, posterior.coefficients(right), drawn)
        penalty = float(matrix.diagonal().sum() / self.fixed.diagonal().sum())
        posterior = Posterior(matrix + penalty * self.fixed, self.exact.rows, self.exact.names)
        moved = right + penalty * (self.exact.rows.T @ self.exact.values)
        found = posterior.coefficients(moved, self.exact.values)
        return self._tested(posterior, found, drawn) if len(self.weights) else self._met(posterior, found, penalty)

    def _tested(self, posterior: Posterior, coefficients: Floats, drawn: Ints) -> Fit:
        """Leaving out rows B of weights w: (1 - H)^-1 of their residuals, H = w^1/2 B C B^T w^1/2."""
        place = self.soft.places[drawn]
        rows = np.unique(place[place >= 0])
        root = np.sqrt(self.weights)
        half = posterior.half(csr_array(diags_array(root[rows]) @ self.soft.rows[rows]))
        beyond = root[:, None] * (self.soft.values - self.soft.rows @ coefficients)
        block = np.searchsorted(rows, place)
        hat = _blocks(place, lambda a, b: np.einsum("ij,ij->j", half[:, block[a, b[0]]], half[:, block[a, b[1]]]))
        free = np.asarray(np.linalg.inv(np.eye(3) - hat + np.finfo(float).eps * np.eye(3)), dtype=np.float64)
        missed = np.where(place[..., None] >= 0, beyond[place], 0.0)
        weights = self.weights[place[:, 0]]
        # Where a datum has no trust, what is left out is what it is beyond the fit.
        plain = self.soft.values[place[:, 0]] - self.soft.rows[place[:, 0]] @ coefficients
        unit = np.maximum(np.sqrt(weights), np.finfo(float).tiny)[:, None]
        left_out = np.where(weights[:, None] > 0, np.einsum("nb,nbd->nd", free[:, 0], missed) / unit, plain)
        taken = np.asarray(np.trace(hat, axis1=1, axis2=2))
        return Fit(coefficients, posterior, taken, left_out, np.asarray(free[:, 0, 0]), weights)

    def _met(self, posterior: Posterior, coefficients: Floats, penalty: float) -> Fit:
        """Where all data are met: by blocks of K^-1 = S^-1 - mu, with K = A M^-1 A^T without the penalty mu."""
        place, full = self.exact.places, posterior.inverse()
        if full is None:
            nothing = np.full(len(place), np.nan)
            return Fit(coefficients, posterior, nothing, nothing[:, None] * self.exact.values[:1], nothing, nothing)
        inverse = full - penalty * np.eye(len(full))
        pull = inverse @ self.exact.values
        block = _blocks(place, lambda a, b: inverse[place[a, b[0]], place[a, b[1]]], missing=1.0)
        spread = np.asarray(np.linalg.inv(block), dtype=np.float64)
        left_out = np.einsum("nb,nbd->nd", spread[:, 0], np.where(place[..., None] >= 0, pull[place], 0.0))
        known = (place >= 0).sum(axis=1).astype(np.float64)
        return Fit(coefficients, posterior, known, left_out, np.asarray(spread[:, 0, 0]), np.ones(len(place)))

    def best_fairing(self, drawn: Ints, *, robust: bool = False) -> float:
        """The fairing of the least error by cross-validation; of the ladder, and then of its steps in between.

        robust: of the least median instead, which half of the data cannot spoil.
        """
        if not len(self.weights):
            return 1.0  # nothing is weighed against the energy
        errors = {float(fairing): self._error(fairing, drawn, robust) for fairing in _LADDER}
        best = min(errors, key=lambda fairing: errors[fairing])
        if not np.isfinite(errors[best]):
            raise FitError("no fairing determines the functions from these data; use more data or fewer functions")
        errors |= {float(best * step): self._error(best * step, drawn, robust) for step in _STEPS}
        return min(errors, key=lambda fairing: errors[fairing])

    def _error(self, fairing: float, drawn: Ints, robust: bool) -> float:
        try:
            found = self.fit(fairing, drawn)
        except FitError:
            return np.inf
        squares = (found.left_out**2).sum(axis=1)
        return float(np.median(squares) if robust else found.weights @ squares)

    @property
    def tried(self) -> Ints:
        """The samples that are left out while fairing is looked for."""
        return drawn_of(len(self.soft.places), _TRIED)


def drawn_of(count: int, most: int) -> Ints:
    """All of so many numbers, or some of them drawn at random, in order."""
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, most, replace=False))


def _blocks(place: Ints, entry: Callable[[Ints, tuple[int, int]], Floats], missing: float = 0.0) -> Floats:
    """Symmetric matrices (n, 3, 3) of the value and the slopes of samples; what a sample lacks is `missing` times 1."""
    found = np.tile(missing * np.eye(3), (len(place), 1, 1))
    for i in range(3):
        for j in range(i + 1):
            both = np.flatnonzero((place[:, i] >= 0) & (place[:, j] >= 0))
            found[both, i, j] = found[both, j, i] = entry(both, (i, j))
    return found


def _gram(size: int, conditions: Conditions, weights: Floats) -> Any:
    gram = Gram(size)
    if len(weights):
        gram.add(conditions.rows, weights)
    return gram.matrices()[0]


def _stiffness(basis: Basis, fair: Samples) -> Any:
    energy = energy_of(basis, fair)
    assert isinstance(basis, DifferentiableBasis)
    stiff = Gram(basis.size)
    for part, chosen in chunks(fair):
        for rows in energy.rows(basis.jet_matrices(part.points, energy.order)):
            stiff.add(rows, energy.weights(chosen, part.stretch))
    return stiff.matrices()[0]
