"""The steps of a sliding fit: data to their feet, equations of Gauss and Newton, fairness in the metric in space."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import DifferentiableBasis, Points, Samples
from orbiframe.functions import feet_of, foot_step, moved
from orbiframe_fitters.chunks import chunks
from orbiframe_fitters.energy import Energy, energy_of, spacing
from orbiframe_fitters.gram import Gram
from orbiframe_fitters.kinks import Kinks
from orbiframe_fitters.slide_step import SlideStep
from orbiframe_fitters.sliding_data import PAIRS, Feet, Schedule, away_from, linearised, products

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# A foot moves at most so many lengths of fairness, or spacings of functions, in one step, and the surface is stretched
# at most so much in fairing.
_LONGEST_STEP = 0.3
_MOST_STRETCH = 30.0
# A step that leaves more than this share of the distance is the last one.
_GAIN = 0.97
# After all steps that are asked for as many more follow, as long as each takes off so much.
_MORE, _LATE_GAIN = 2, 0.85
# With creases at least so many, for planes become flat while curved sides have long settled.
_LEAST_STEPS = 4
# A smooth surface is shrunk to at least so much in one step at every datum: beyond, a limb is being pinched off.
_LEAST_SHARE = 0.35
# Fairness grows by such a factor where it would, up to this one.
_STIFFER, _STIFFEST = 10.0, 1e4
# So many steps of Newton's lead data that were left out so far to their feet.
_ALL_STEPS = 2
# How much a kink across a hair counts against a distance of what it would lift at the spacing of the functions.
_KINK = 10.0
# How much a jump of the slope within the surface counts against a kink, beside curved facets, and if all are flat.
_SLIDE = 1e-5, 1e-7


class _Fairness(NamedTuple):
    """Samples where fairness is asked for: which of all, the rows of the energy, and those of the two slopes."""

    chosen: Ints
    rows: list[csr_array]
    slopes: list[csr_array]


class Slide:
    """The data of a sliding fit, chunk by chunk, and its steps.

    fair: the samples over which fairness is summed up, by default those of the data.
    """

    def __init__(
        self,
        basis: DifferentiableBasis,
        samples: Samples,
        schedules: tuple[Schedule, ...],
        fair: Samples | None = None,
    ) -> None:
        self.basis, self.fair, self.schedules = basis, samples if fair is None else fair, schedules
        self.energy = energy_of(basis, self.fair) if any(schedule.fairing for schedule in schedules) else None
        self.data = [
            part.take(np.flatnonzero(part.weights > 0)) for part, _ in chunks(samples) if (part.weights > 0).any()
        ]
        self.fairness = self._fairness(self.energy) if self.energy else []
        self.kinks, self.creased = Kinks.of(basis), samples.still is not None
        self.flat = samples.still is not None and bool(samples.still.all())
        self.spacing = spacing(basis, samples)
        length = np.full(len(samples.weights), self.spacing)
        length = length if samples.length is None else np.maximum(length, samples.length)
        self.longest = [
            _LONGEST_STEP * length[chosen[part.weights > 0]]
            for part, chosen in chunks(samples)
            if (part.weights > 0).any()
        ]

    def _fairness(self, energy: Energy) -> list[_Fairness]:
        found = []
        for part, chosen in chunks(self.fair):
            jets = self.basis.jet_matrices(part.points, energy.order)
            found.append(_Fairness(chosen, energy.rows(jets), jets[1:3]))
        return found

    def from_start(self, coefficients: Floats, steps: int) -> Floats:
        """The coefficients after so many steps, more where they help much; one that leads away is halved, then refused.

        A step that would pinch off something asks for more fairness, for all steps to come.
        """
        feet = self._slid([self._feet(part.points, part.values, coefficients) for part in self.data], coefficients)
        distance, stiffer = self._distance(feet), 1.0
        for step in range(_MORE * steps):
            schedule = self.schedules[min(step, len(self.schedules) - 1)]
            equations = self._assembled(feet, coefficients, schedule)
            change = equations.change(stiffer * schedule.fairing)
            while self._pinched(coefficients, coefficients + change) and stiffer < _STIFFEST:
                stiffer *= _STIFFER
                change = equations.change(stiffer * schedule.fairing)
            before = distance
            for share in (1.0, 0.5, 0.25):
                trial = coefficients + share * change
                if self._pinched(coefficients, trial):
                    continue
                there = self._slid(self._under(feet, trial), trial)
                distance = self._distance(there)
                if distance < before:
                    break
            else:
                return coefficients
            coefficients, feet = trial, there
            gain = _GAIN if step < steps - 1 else _LATE_GAIN
            if distance > gain * before and step >= (_LEAST_STEPS if self.creased else len(self.schedules)) - 1:
                break
        return coefficients

    def with_all(self, coefficients: Floats, samples: Samples, schedule: Schedule) -> Floats:
        """The coefficients after one more step for which all samples count, each once and in no memory but its own."""
        gram, right = self._empty()
        longest = _LONGEST_STEP * self.spacing
        for part, _ in chunks(samples.take(np.flatnonzero(samples.weights > 0))):
            points, _, jets = feet_of(self.basis, coefficients, part.points, part.values, longest, _ALL_STEPS)
            feet = Feet(points, self.basis.jet_matrices(points, 0), jets, part.values - jets[0])
            self._enter(gram, right, feet, part, schedule)
        trial = coefficients + self._step(gram, right, coefficients).change(schedule.fairing)
        return coefficients if self._pinched(coefficients, trial) else trial

    def _feet(self, points: Points, targets: Floats, coefficients: Floats) -> Feet:
        matrices = self.basis.jet_matrices(points, 2)
        jets = products(matrices, coefficients)
        return Feet(points, matrices, jets, targets - jets[0])

    def _under(self, feet: list[Feet], coefficients: Floats) -> list[Feet]:
        return [found.under(coefficients, part.values) for found, part in zip(feet, self.data, strict=True)]

    def _distance(self, feet: list[Feet]) -> float:
        total = sum(
            float(part.weights @ away_from(found, part) ** 2) for found, part in zip(feet, self.data, strict=True)
        )
        return float(np.sqrt(total / sum(part.weights.sum() for part in self.data)))

    def _slid(self, feet: list[Feet], coefficients: Floats) -> list[Feet]:
        """Every datum one step of Newton's method nearer to its foot."""
        return [self._slid_part(*each, coefficients) for each in zip(feet, self.data, self.longest, strict=True)]

    def _slid_part(self, feet: Feet, part: Samples, longest: Floats, coefficients: Floats) -> Feet:
        kept = [mark for mark in (part.still, part.held) if mark is not None]
        if kept:
            return self._slid_some(feet, part, longest, coefficients, np.flatnonzero(~np.logical_or.reduce(kept)))
        return self._slid_all(feet, part, longest, coefficients)

    def _slid_some(self, feet: Feet, part: Samples, longest: Floats, coefficients: Floats, chosen: Ints) -> Feet:
        """Only some of the data slide."""
        if not len(chosen):
            return feet
        found = self._slid_all(feet.take(chosen), part.take(chosen), longest[chosen], coefficients)
        return feet.replaced(chosen, found)

    def _slid_all(self, feet: Feet, part: Samples, longest: Floats, coefficients: Floats) -> Feet:
        step = foot_step(feet.jets, part.values, longest)
        found = self._feet(moved(self.basis.orbifold, feet.points, step), part.values, coefficients)
        for share in (1.0, 0.25):
            worse = np.flatnonzero(~(found.distance < feet.distance))
            if not len(worse):
                return found
            back = feet.take(worse)
            step = share * foot_step(back.jets, part.values[worse], longest[worse], bent=False)
            again = self._feet(moved(self.basis.orbifold, back.points, step), part.values[worse], coefficients)
            found = found.replaced(worse, again)
        worse = np.flatnonzero(~(found.distance < feet.distance))
        return found.replaced(worse, feet.take(worse))

    def _assembled(self, feet: list[Feet], coefficients: Floats, schedule: Schedule) -> SlideStep:
        """The equations of one step of Gauss and Newton."""
        gram, right = self._empty()
        for found, part in zip(feet, self.data, strict=True):
            self._enter(gram, right, found, part, schedule)
        return self._step(gram, right, coefficients)

    def _empty(self) -> tuple[Gram, Floats]:
        """The equations of a step before any data."""
        return Gram(self.basis.size, 6, self._room), np.zeros((self.basis.size, 3))

    @staticmethod
    def _enter(gram: Gram, right: Floats, feet: Feet, part: Samples, schedule: Schedule) -> None:
        """Add some data to the equations of a step."""
        weights, wanted = linearised(feet, part, schedule)
        gram.add(feet.matrices[0], weights)
        right += feet.matrices[0].T @ wanted

    def _step(self, gram: Gram, right: Floats, coefficients: Floats) -> SlideStep:
        """The equations in which all data are entered; the rest is added here."""
        if self.kinks is not None:
            weights, wanted = self._smoothed(self.kinks, coefficients)
            gram.add(self.kinks.jump, weights)
            right += self.kinks.jump.T @ wanted
        if self.energy is None:
            return SlideStep(gram, right, None, np.zeros_like(right), self.creased)
        bend = self._stiffness(coefficients, self.energy)
        return SlideStep(gram, right, bend, np.asarray(bend @ coefficients), self.creased)

    @property
    def _room(self) -> float | None:
        """Up to how many numbers matrices are dense: with creases the equations are solved as a whole, and sparse."""
        return 0.0 if self.creased else None

    def _smoothed(self, kinks: Kinks, coefficients: Floats) -> tuple[Floats, Floats]:
        """For each point of a hair the six entries of the form of its kink, (n, 6), and its right side, (n, 3).

        What jumps within the surface counts a little too: nothing else holds the parameters of planes beside corners.
        """
        normal, kink = kinks.seen(coefficients)
        size = np.maximum(np.linalg.norm(kinks.across @ coefficients, axis=1), np.finfo(float).tiny)
        weight, slide = _KINK * self.spacing**4 / size, _SLIDE[self.flat]
        form = np.stack([normal[:, a] * normal[:, b] for a, b in PAIRS], axis=1)
        form[:, [0, 3, 5]] += slide
        wanted = kink[:, None] * normal + slide * (kinks.jump @ coefficients) / size[:, None]
        return (weight / size)[:, None] * form, -weight[:, None] * wanted

    def _pinched(self, before: Floats, after: Floats) -> bool:
        """Whether a smooth surface shrinks too much somewhere; facets may, where an edge becomes sharp."""
        if self.energy is None or self.energy.order < 3:
            return False
        pairs = ((_elements(part, before), _elements(part, after)) for part in self.fairness)
        return any((new < _LEAST_SHARE * old).any() for old, new in pairs)

    def _stiffness(self, coefficients: Floats, energy: Energy) -> Floats | csr_array:
        """The energy in the metric of the surface as it is."""
        gram = Gram(self.basis.size, most=self._room)
        for part in self.fairness:
            chosen, rows, _ = part
            stretch = np.minimum(1 / _elements(part, coefficients), _MOST_STRETCH * self.fair.stretch[chosen])
            for row in rows:
                gram.add(row, energy.weights(chosen, stretch))
        return gram.matrices()[0]


def _elements(part: _Fairness, coefficients: Floats) -> Floats:
    """The elements of area of the surface at samples, positive."""
    first, second = (slope @ coefficients for slope in part.slopes)
    return np.asarray(np.maximum(np.linalg.norm(np.cross(first, second), axis=1), np.finfo(float).tiny))
