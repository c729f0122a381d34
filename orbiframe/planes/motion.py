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
    square, size = _form(spin), float(np.abs(spin).max())
    # spin is known up to `small`, hence its square up to small times size.
    if parity > 0 and cosine > 0 and abs(square) <= 4 * small * size:
        return Motion("parabolic", point=spin / spin[0])
    if parity > 0 and (cosine < 0 or square > 0):
        point = spin if cosine > 0 else _fixed_vector(g, inverse, cosine)
        point = np.copysign(1.0, point[0]) * point / np.sqrt(_form(point))
        return Motion("rotation", float(np.arctan2(_dot(spin, point), cosine)), point=point)
    pole = spin if parity > 0 else _fixed_vector(g, inverse, cosine)
    pole = pole / np.sqrt(-_form(pole))
    line, length = pole * [1.0, -1.0, -1.0], float(np.arcsinh(np.sqrt(max(-square, 0.0))))
    if parity > 0:
        return Motion("translation", length=length, line=line)
    return Motion("reflection", line=line) if length <= small else Motion("glide", length=length, line=line)


def _fixed_vector(g: Floats, inverse: Floats, cosine: float) -> Floats:
    """The eigenvector of g for its real eigenvalue +1 or -1: the longest column of the projector on it, scaled."""
    projector = (g + inverse) / 2 - cosine * np.eye(3)
    return np.asarray(projector[:, np.argmax(np.sum(projector**2, axis=0))])


def _form(x: Floats) -> float:
    return _dot(x, x)


def _dot(x: Floats, y: Floats) -> float:
    return float(x[0] * y[0] - x[1] * y[1] - x[2] * y[2])
