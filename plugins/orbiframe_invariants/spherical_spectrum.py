"""Spectra of spherical orbifolds: the harmonics that a finite group leaves as they are, counted by characters."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError
from orbiframe_invariants.laplace_spectrum import Eigenvalue

Floats = NDArray[np.float64]


def spherical_spectrum(elements: Floats, count: int) -> list[Eigenvalue]:
    """The `count` smallest different eigenvalues of S^2/H, with derivative zero across mirrors: exact.

    elements: (k, 3, 3), all of H. Harmonics of degree l have the eigenvalue l (l + 1); those that are invariant under H
    are as many as the mean over H of the characters, which are sin((2 l + 1) t / 2) / sin(t / 2) for a turn by t, and
    (-1)^l times that for -1 times a turn. Raises FitError for a count below 1.
    """
    if count < 1:
        raise FitError(f"{count} eigenvalues are wanted; ask for at least 1")
    found: list[Eigenvalue] = []
    degree = 0
    while len(found) < count:
        if multiplicity := invariant_harmonics(elements, degree):
            found.append(Eigenvalue(float(degree * (degree + 1)), multiplicity, 0.0))
        degree += 1
    return found


def invariant_harmonics(elements: Floats, degree: int) -> int:
    """How many independent harmonics of this degree are invariant under all elements (k, 3, 3)."""
    parity = np.sign(np.linalg.det(elements))
    cosine = np.clip((parity * np.trace(elements, axis1=1, axis2=2) - 1) / 2, -1, 1)
    # 1 + 2 cos t + ... + 2 cos l t has no quotient that could be 0 / 0.
    orders = np.arange(1, degree + 1)
    characters = 1 + 2 * np.cos(orders * np.arccos(cosine)[:, None]).sum(axis=1)
    return round(float(np.mean(np.where(parity > 0, 1, (-1) ** degree) * characters)))
