"""Motion: what an isometry of a plane of constant curvature does (section 1.1, with glide reflections named)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Motion:
    """The kind of an isometry and the data that determine it.

    kind: "identity", "rotation", "translation", "parabolic" (fixes one ideal point), "reflection", "glide" or
    "rotary reflection" (S^2 only, the antipodal map included); angle: of the rotation, counterclockwise about `point`,
    in (-pi, pi]; length: by which points of the axis move; point: the fixed point of a rotation, the pole of a rotary
    reflection, the ideal point (1, cos, sin) of a parabolic motion; line: (3,), the axis or mirror is the set of x with
    line . x = 0. On S^2 a translation along a great circle is a rotation and is called so.
    """

    kind: str
    angle: float = 0.0
    length: float = 0.0
    point: Floats | None = None
    line: Floats | None = None


def find_motion(curvature: int, g: Floats, inverse: Floats, parity: int, tolerance: float) -> Motion:
    """The motion of the isometry g (3, 3) with the given inverse and parity; `tolerance` is relative to |g|."""
    small = tolerance * max(1.0, float(np.abs(g).max()))
    if parity > 0 and np.abs(g - np.eye(3)).max() <= small:
        return Motion("identity")
    if curvature == 0:
        return _flat_motion(g, parity, small)
    # (g - g^-1) / 2 is x -> spin "turned by 90 degrees along" x: spin spans the fixed line, its size is the sine.
    skew = np.array([[curvature], [1.0], [1.0]]) * (g - inverse) / 2
    spin = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    cosine = (np.trace(g) - parity) / 2
    return (_spherical_motion if curvature > 0 else _hyperbolic_motion)(g, inverse, parity, small, spin, cosine)


def _flat_motion(g: Floats, parity: int, small: float) -> Motion:
    shift, angle = g[1:, 0], float(np.arctan2(g[2, 1], g[1, 1]))
    if parity > 0 and abs(angle) <= small:
        direction = shift / np.linalg.norm(shift)
        return Motion("translation", length=float(np.linalg.norm(shift)), line=_flat_line(direction, 0.0))
    if parity > 0:
        centre = np.linalg.solve(np.eye(2) - g[1:, 1:], shift)
        return Motion("rotation", angle, point=np.array([1.0, *centre]))
    direction = np.array([np.cos(angle / 2), np.sin(angle / 2)])
    along = float(direction @ shift)
    line = _flat_line(direction, float(direction[0] * shift[1] - direction[1] * shift[0]) / 2)
    return Motion("reflection", line=line) if abs(along) <= small else Motion("glide", length=along, line=line)


def _flat_line(direction: Floats, offset: float) -> Floats:
    return np.array([-offset, -direction[1], direction[0]])


def _spherical_motion(g: Floats, inverse: Floats, parity: int, small: float, spin: Floats, cosine: float) -> Motion:
    if parity < 0 and np.abs(g + np.eye(3)).max() <= small:
        return Motion("rotary reflection", np.pi, point=np.array([1.0, 0.0, 0.0]))
    sine = float(np.linalg.norm(spin))
    axis = spin / sine if parity * cosine > 0 and sine > small else _fixed_vector(g, inverse, cosine)
    axis = axis / np.linalg.norm(axis)
    angle = float(np.arctan2(spin @ axis, cosine))
    if parity > 0:
        return Motion("rotation", angle, point=axis)
    return Motion("reflection", line=axis) if abs(angle) <= small else Motion("rotary reflection", angle, point=axis)


def _hyperbolic_motion(g: Floats, inverse: Floats, parity: int, small: float, spin: Floats, cosine: float) -> Motion:
    """By sin^2 or -sinh^2, from the trace or from the spin, whichever rounding leaves more of.

    The trace is known up to `small` wherever the axis lies, the form of the spin up to small times its size: the first
    serves far from the origin, the second near the identity.
    """
    by_trace, by_spin = (1 - cosine) * (1 + cosine), _form(spin)
    doubt, other = 2 * small * max(1.0, abs(cosine)), 4 * small * float(np.abs(spin).max())
    square, doubt = (by_spin, other) if other <= doubt else (by_trace, doubt)
    sine = float(np.sqrt(abs(square)))
    if parity > 0 and cosine > 0 and abs(square) <= doubt:
        return Motion("parabolic", point=spin / spin[0])
    if parity > 0 and (cosine < 0 or square > 0):
        return _hyperbolic_rotation(g, inverse, spin, sine, cosine)
    length = float(np.arcsinh(sine)) if square < 0 else 0.0
    pole = spin / sine if parity > 0 else _reversed_vector(g, inverse, cosine)
    line = pole * [1.0, -1.0, -1.0]
    if parity > 0:
        return Motion("translation", length=length, line=line)
    return Motion("reflection", line=line) if length <= small else Motion("glide", length=length, line=line)


def _hyperbolic_rotation(g: Floats, inverse: Floats, spin: Floats, sine: float, cosine: float) -> Motion:
    """The spin is the sine times the centre x, and (g + g^-1) / 2 - cos is (1 - cos) x x^T J."""
    turned = np.copysign(sine, spin[0])
    if cosine > 0:
        point = spin / turned
    else:
        column = ((g + inverse) / 2 - cosine * np.eye(3))[:, 0]
        point = column / np.sqrt(column[0] * (1 - cosine))
    point[0] = np.sqrt(1 + point[1] ** 2 + point[2] ** 2)
    return Motion("rotation", float(np.arctan2(turned, cosine)), point=point)


def _reversed_vector(g: Floats, inverse: Floats, cosine: float) -> Floats:
    """The unit vector n that a glide reverses: (g + g^-1) / 2 - cosh = (1 + cosh) n n^T J, J = diag(1, -1, -1)."""
    scaled = ((g + inverse) / 2 - cosine * np.eye(3)) * [1.0, -1.0, -1.0]
    k = int(np.argmax(np.diag(scaled)))
    return np.asarray(scaled[:, k] / np.sqrt(scaled[k, k] * (1 + cosine)))


def _fixed_vector(g: Floats, inverse: Floats, cosine: float) -> Floats:
    """The eigenvector of g for its real eigenvalue +1 or -1: the longest column of the projector on it, scaled."""
    projector = (g + inverse) / 2 - cosine * np.eye(3)
    return np.asarray(projector[:, np.argmax(np.sum(projector**2, axis=0))])


def _form(x: Floats) -> float:
    return float(x[0] ** 2 - x[1] ** 2 - x[2] ** 2)
