"""Given normals: a fitted surface moved, as little as its energy allows, until it has the normals that are fixed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve
from scipy.linalg.lapack import dpstrf
from scipy.sparse import csr_array

from orbiframe import Basis, DifferentiableBasis, FitError, Samples
from orbiframe_fitters.conditions import normal_rows
from orbiframe_fitters.posterior import Posterior

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_RANK = 1e-10
_MISSED = 1e-8
_STEPS = 3
# Of a tangent plane: the sine of the angle of the two derivatives at least.
_FLAT = 1e-3


def with_normals(basis: Basis, samples: Samples, posterior: Posterior, coefficients: Floats) -> Floats:
    """The coefficients (size, 3) of least energy whose surface has the normals of the fixed samples that have one.

    Both derivatives are orthogonal to the normal there, which is linear in the coefficients of the three coordinates
    together, and does not know n from -n; other fixed samples stay met. Raises FitError where normals contradict one
    another or fixed points.
    """
    if samples.normals is None or samples.fixed is None or samples.values.shape[1] != 3:
        return coefficients
    chosen = np.flatnonzero(samples.fixed & (samples.weights > 0) & np.isfinite(samples.normals).all(axis=1))
    if not len(chosen):
        return coefficients
    rows = normal_rows(basis, samples, chosen)
    moves = [posterior.moves(part) for part in rows]
    product = sum((part @ move for part, move in zip(rows, moves, strict=True)), start=np.zeros((2 * len(chosen),) * 2))
    norm = np.sqrt(np.maximum(np.diagonal(product), np.finfo(float).tiny))
    factor, pivots, rank, _ = dpstrf(product / np.outer(norm, norm), lower=1, tol=_RANK)
    independent = pivots[:rank].astype(np.intp) - 1
    lower = norm[independent, None] * np.tril(factor[:rank, :rank])
    found, size = coefficients.copy(), _turned([abs(part) for part in rows], np.abs(coefficients)).max()
    for _ in range(_STEPS):
        pull = cho_solve((lower, True), _turned(rows, found)[independent])
        found -= np.stack([move[:, independent] @ pull for move in moves], axis=1)
    missed = (np.abs(_turned(rows, found)) > _MISSED * size).reshape(2, -1).any(axis=0)
    missed |= _flat(basis, samples, chosen, found)
    if missed.any():
        named = ", ".join(str(k) for k in chosen[missed][:5])
        raise FitError(
            f"the normals of {len(chosen)} fixed samples are {2 * len(chosen)} conditions of rank {rank}, and those of "
            f"the samples {named} cannot be met; fix fewer of them, or use more functions (the option size)"
        )
    return found


def _flat(basis: Basis, samples: Samples, chosen: Ints, coefficients: Floats) -> NDArray[np.bool_]:
    """Where the two derivatives have become one direction, which is orthogonal to several normals."""
    assert isinstance(basis, DifferentiableBasis)
    _, first, second = basis.jets(samples.take(chosen).points, coefficients, 1)
    area = np.linalg.norm(np.cross(first, second), axis=1)
    return np.asarray(area < _FLAT * np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1))


def _turned(rows: list[csr_array], coefficients: Floats) -> Floats:
    """How far the derivatives are from being orthogonal to the normals, (2 k,)."""
    return np.asarray(sum(part @ coefficients[:, a] for a, part in enumerate(rows)))
