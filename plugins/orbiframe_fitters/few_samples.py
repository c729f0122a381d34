"""Few samples: some of very many that stand for all, as many for each function."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from orbiframe import Basis, Samples
from orbiframe_fitters.chunks import chunks

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Of all samples at which one function is the largest at most so many are kept: of data, and of fairness alone.
_PER_FUNCTION, _FAIR = 24, 12
# So many cost little.
_CHEAP = 1 << 15


class FewSamples(NamedTuple):
    """Samples that stand for all: `data` in every step of a fit, `fair` for the integrals of fairness."""

    data: Samples
    fair: Samples


def few_samples(basis: Basis, samples: Samples) -> FewSamples:
    """Samples of which no function has more than it needs; their weights and areas are those of all.

    Those at which one function is the largest make a group, and of a group as many are left out between any two that
    are kept, in the order of a curve that fills it; samples that count are kept apart from those of fairness alone, and
    those that are held all remain. Gives the samples themselves where they are cheap, where that would leave out less
    than half, and along creases, where some do not slide.
    """
    if samples.still is not None or len(samples.weights) <= max(2 * _FAIR * basis.size, _CHEAP):
        return FewSamples(samples, samples)
    order, largest = [], []
    for part, chosen in chunks(samples):
        order.append(chosen)
        largest.append(_largest(basis.design_matrix(part.points)))
    place, function = np.concatenate(order), np.concatenate(largest)
    group = 2 * function + (samples.weights[place] > 0)
    if samples.held is not None:
        group[samples.held[place]] = 2 * basis.size
    data = _thinned(samples, place, group, 2 * basis.size, _PER_FUNCTION)
    return FewSamples(data, _thinned(samples, place, function, basis.size, _FAIR))


def _thinned(samples: Samples, place: Ints, group: Ints, whole: int, most: int) -> Samples:
    """So many samples of each group at most; all of group `whole`; the samples themselves if half of them were left."""
    kept, group_of = _kept(place, group, whole, most)
    if 2 * len(kept) > len(samples.weights):
        return samples
    found = samples.take(kept)
    weights = found.weights * _factor(group, samples.weights[place], group_of, found.weights)
    area = samples.shares[place]
    return replace(found, weights=weights, area=found.shares * _factor(group, area, group_of, found.shares))


def _largest(rows: csr_array) -> Ints:
    """The column of the largest entry of each row."""
    most = np.maximum.reduceat(rows.data, rows.indptr[:-1])
    row = np.repeat(np.arange(rows.shape[0]), np.diff(rows.indptr))
    first = np.flatnonzero(rows.data == most[row])
    found = np.zeros(rows.shape[0], dtype=np.intp)
    found[row[first][::-1]] = rows.indices[first][::-1]
    return found


def _kept(place: Ints, group: Ints, whole: int, most: int) -> tuple[Ints, Ints]:
    """The samples that are kept, and the group of each; from group `whole` on all are."""
    order = np.argsort(group, kind="stable")
    count = np.bincount(group)
    rank = np.arange(len(group)) - np.repeat(np.cumsum(count) - count, count)
    wanted = np.minimum(most / np.maximum(count, 1), 1.0)
    wanted[whole:] = 1.0
    share = wanted[group[order]]
    chosen = order[np.floor((rank + 1) * share + 1e-9) > np.floor(rank * share + 1e-9)]
    return place[chosen], group[chosen]


def _factor(group: Ints, all_of_it: Floats, group_of: Ints, left: Floats) -> Floats:
    """By how much what is left of each group must grow to be all of it, for each sample that is kept."""
    whole = np.bincount(group, weights=all_of_it)
    part = np.bincount(group_of, weights=left, minlength=len(whole))
    return np.asarray((whole / np.where(part > 0, part, 1.0))[group_of])
