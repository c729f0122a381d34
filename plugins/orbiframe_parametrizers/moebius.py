"""Moebius: circles of the plane on the sphere, and the Moebius map that centres them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe import MapError

Floats = NDArray[np.float64]

_STEPS = 500
_LARGEST = 2.0
_BALANCED = 1e-13
_SMALLEST_BOOST = 1e-14
_ACCEPTED = 1e-9


class Centred(NamedTuple):
    """The centres (V, 3) of caps on the unit sphere, and the Moebius map of the plane that centred them, (2, 2).

    The map takes z to (a z + b) / (c z + d), and its determinant is known without a difference of large numbers.
    """

    centres: Floats
    matrix: NDArray[np.complex128]
    determinant: float


def centred_caps(z: NDArray[np.complex128], radii: Floats, weights: Floats) -> Centred:
    """Circles z (V,) with radii (V,) of the plane on the unit sphere, moved so that their weighted mean is zero.

    Points are circles of radius 0.
    A circle is the vector (cos rho, c) / sin rho of its spherical cap (centre c, angular radius rho) in the Lorentz
    space R^(1,3), on which Moebius maps act as Lorentz maps. Newton steps: a small boost b moves a small cap by
    (I - c c^T) b. For points the balanced position exists and is unique up to rotation (Springborn 2005, the minimum
    of a convex function on H^3); big steps are cut to rapidity 2. Raises MapError without
    convergence, as where z is not finite or all weights are 0.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return _balanced(z, radii, weights / weights.sum())


def _balanced(z: NDArray[np.complex128], radii: Floats, weights: Floats) -> Centred:
    middle = np.average(z, weights=weights)
    scale = float(np.average(np.abs(z - middle), weights=weights))
    caps = _caps((z - middle) / scale, radii / scale)
    matrix = np.array([[1, -middle], [0, scale]])
    for _ in range(_STEPS):
        centres = caps[:, 1:] / np.linalg.norm(caps[:, 1:], axis=1, keepdims=True)
        mean = weights @ centres
        if not np.linalg.norm(mean) >= _BALANCED:
            break
        spread = np.eye(3) - np.einsum("v,vi,vj->ij", weights, centres, centres)
        boost = -np.linalg.lstsq(spread, mean)[0]
        size = float(np.linalg.norm(boost))
        if size < _SMALLEST_BOOST:
            break
        rapidity = min(size, _LARGEST)
        caps = caps @ _boost(boost / size, rapidity).T
        matrix = _moebius(boost / size, rapidity) @ matrix
    if not np.linalg.norm(mean) < _ACCEPTED:
        raise MapError("the sphere could not be balanced: the mesh is too crowded for doubles; shorten thin parts")
    return Centred(np.asarray(centres), matrix, scale)


def _moebius(direction: Floats, rapidity: float) -> NDArray[np.complex128]:
    """The Moebius map of the plane, of determinant 1, that is the boost of the sphere towards a direction."""
    n0, across = direction[0], direction[1] + 1j * direction[2]
    towards = np.array([[-n0, across], [np.conj(across), n0]])
    return np.asarray(np.cosh(rapidity / 2) * np.eye(2) + np.sinh(rapidity / 2) * towards)


def _caps(z: NDArray[np.complex128], radii: Floats) -> Floats:
    """Lorentz vectors (V, 4) of the circles, times r, under the stereographic projection that sends 0 to (1, 0, 0).

    The factor makes points the circles of radius 0; the boosts are linear, and only the centres are read off.
    """
    power = (np.abs(z) - radii) * (np.abs(z) + radii)
    return np.stack([(1 + power) / 2, (1 - power) / 2, z.real, z.imag], axis=1)


def _boost(direction: Floats, rapidity: float) -> Floats:
    boost = np.eye(4)
    boost[0, 0] = np.cosh(rapidity)
    boost[0, 1:] = boost[1:, 0] = np.sinh(rapidity) * direction
    boost[1:, 1:] += (np.cosh(rapidity) - 1) * np.outer(direction, direction)
    return boost
