"""Principal curvatures and directions of a surface in space, from its two fundamental forms."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]


class PrincipalCurvature(NamedTuple):
    """The most and the least that a surface bends, (n,) each, in which directions, (n, 3) each, and its normal (n, 3).

    Positive where the surface bends towards the normal, so that most >= least; their mean is the mean curvature, their
    product the Gaussian one. The directions are unit vectors, orthogonal to each other and to the normal; where the
    surface bends alike in all directions, they are any such two.
    """

    most: Floats
    least: Floats
    along_most: Floats
    along_least: Floats
    normal: Floats

    def turned(self, signs: Floats) -> PrincipalCurvature:
        """The same with the normals times signs, (n,), of 1 and -1."""
        back = signs < 0
        most, least = np.where(back, -self.least, self.most), np.where(back, -self.most, self.least)
        swap = back[:, None]
        return PrincipalCurvature(
            most,
            least,
            np.where(swap, self.along_least, self.along_most),
            np.where(swap, self.along_most, self.along_least),
            signs[:, None] * self.normal,
        )


def principal_curvature(surface: OrbifoldSurface, points: Points) -> PrincipalCurvature:
    """The principal curvatures of a surface over n points of X/H.

    In the orthonormal basis t1 = S1 / |S1|, t2 = n x t1 of the tangent plane, S1 = a t1 and S2 = b t1 + c t2, and the
    second form is L^-1 B L^-T with the rows (a, 0), (b, c) of L and the entries B of normal parts of the covariant
    Hessian. Raises FitError for a basis without derivatives. Where the surface is not immersed, the numbers are not
    finite.

    >>> from orbiframe import fit
    >>> from orbiframe.surfaces import nearest_points, principal_curvature
    >>> surface = fit("dataset:torus", size=300).surface
    >>> points, _ = nearest_points(surface, [[1.4, 0, 0]])
    >>> found = principal_curvature(surface, points)
    >>> print(found.most.round(1), found.least.round(1))  # 1 / 1.4 and 1 / 0.4; outward normals make both negative
    [-0.7] [-2.5]
    """
    jet = surface.jet(points)
    with np.errstate(all="ignore"):
        normal = np.cross(jet.first[:, 0], jet.first[:, 1])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        a = np.linalg.norm(jet.first[:, 0], axis=1)
        t1 = jet.first[:, 0] / a[:, None]
        t2 = np.cross(normal, t1)
        b, c = (np.einsum("ni,ni->n", t, jet.first[:, 1]) for t in (t1, t2))
        s11, s12, s22 = np.einsum("nki,ni->kn", jet.second, normal)
        p = s11 / a**2
        q = (s12 / a - b * p) / c
        r = (s22 - 2 * b * c * q - b**2 * p) / c**2
        mean, half, twist = (p + r) / 2, (p - r) / 2, q
        away = np.hypot(half, twist)
        angle = np.arctan2(twist, half) / 2
    along = np.cos(angle)[:, None] * t1 + np.sin(angle)[:, None] * t2
    return PrincipalCurvature(mean + away, mean - away, along, np.cross(normal, along), normal)
