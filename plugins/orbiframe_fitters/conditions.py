"""Conditions: samples as rows of linear equations, those that are nearly met and those that are met exactly."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array, vstack

from orbiframe import Basis, DifferentiableBasis, FitError, Samples
from orbiframe_fitters.chunks import chunks

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


class Conditions(NamedTuple):
    """Rows, sparse (m, size), that shall give values (m, d): the values and slopes of samples.

    sample: (m,), of which sample each is; kind: (m,), 0 its value, 1 and 2 its derivatives along the frame.
    """

    rows: csr_array
    values: Floats
    sample: Ints
    kind: Ints

    def take(self, chosen: Ints | NDArray[np.bool_]) -> Conditions:
        """Some of them."""
        rows = csr_array(self.rows[chosen])
        return Conditions(rows, self.values[chosen], self.sample[chosen], self.kind[chosen])

    @property
    def places(self) -> Ints:
        """For every sample of theirs the numbers of its value and its two slopes, (n, 3), -1 for what it lacks."""
        number = np.unique(self.sample, return_inverse=True)[1]
        found = np.full((number.max(initial=-1) + 1, 3), -1, dtype=np.intp)
        found[number, self.kind] = np.arange(len(number))
        return found

    @property
    def names(self) -> list[str]:
        """Each in words."""
        kinds = ("the value", "the first slope", "the second slope")
        return [f"{kinds[k]} of sample {s}" for s, k in zip(self.sample, self.kind, strict=True)]


def conditions_of(basis: Basis, samples: Samples, counted: Ints) -> Conditions:
    """Those of the samples that count, values before slopes. Raises FitError for slopes of functions without any."""
    data = samples.take(counted)
    order = 0 if data.slopes is None else 1
    parts, places = zip(*((_jets(basis, part, order), chosen) for part, chosen in chunks(data)), strict=True)
    back = np.argsort(np.concatenate(places))
    jets = [csr_array(csr_array(vstack(rows))[back]) for rows in zip(*parts, strict=True)]
    every, zero = np.arange(len(counted)), np.zeros(len(counted), dtype=np.intp)
    if data.slopes is None:
        return Conditions(jets[0], data.values, counted, zero)
    known = [every, *(np.flatnonzero(np.isfinite(data.slopes[:, :, k]).all(axis=1)) for k in range(2))]
    values = np.concatenate([data.values, *(data.slopes[known[k + 1], :, k] for k in range(2))])
    rows = csr_array(vstack([jets[k][chosen] for k, chosen in enumerate(known)]))
    kind = np.repeat(np.arange(3), [len(chosen) for chosen in known])
    return Conditions(rows, values, counted[np.concatenate(known)], kind)


def normal_rows(basis: Basis, samples: Samples, chosen: Ints) -> list[csr_array]:
    """Rows (2 k, size) for each of three coordinates, whose sum is 0 where the surface has the normals of the samples.

    The derivatives of the surface along both axes of the frame are orthogonal to the given normal: no approximation.
    """
    data = samples.take(chosen)
    assert data.normals is not None
    jets = _jets(basis, data, 1)
    return [csr_array(vstack([diags_array(data.normals[:, a]) @ jets[k] for k in (1, 2)])) for a in range(3)]


def _jets(basis: Basis, samples: Samples, order: int) -> list[csr_array]:
    if order == 0:
        return [basis.design_matrix(samples.points)]
    if not isinstance(basis, DifferentiableBasis):
        raise FitError(
            f"{type(basis).__name__} knows no derivatives, which slopes and normals need; choose another basis"
        )
    return basis.jet_matrices(samples.points, order)
