"""The three geometries and oracles at fifty digits, for the tests of the kernel."""

import mpmath
import numpy as np
from orbiframe_geometries.e2 import E2
from orbiframe_geometries.h2 import H2
from orbiframe_geometries.s2 import S2

GEOMETRIES = [S2(), E2(), H2()]
mpmath.mp.dps = 50


def exact_point(geometry, x):
    """The point that the floating-point numbers x stand for: (x1, x2) in E2 and H2, the ray of x in S2."""
    x0, x1, x2 = (mpmath.mpf(float(value)) for value in x)
    if geometry.curvature == 1:
        length = mpmath.sqrt(x0**2 + x1**2 + x2**2)
        return x0 / length, x1 / length, x2 / length
    return mpmath.sqrt(1 - geometry.curvature * (x1**2 + x2**2)), x1, x2


def exact_distance(geometry, x, y):
    p, q = exact_point(geometry, x), exact_point(geometry, y)
    apart = [b - a for a, b in zip(p, q, strict=True)]
    if geometry.curvature == 0:
        return mpmath.hypot(apart[1], apart[2])
    if geometry.curvature == -1:
        return mpmath.acosh(p[0] * q[0] - p[1] * q[1] - p[2] * q[2])
    along = [a + b for a, b in zip(p, q, strict=True)]
    return 2 * mpmath.atan2(mpmath.norm(apart), mpmath.norm(along))


def random_points(geometry, rng, count, reach=1.4):
    return geometry.from_polar(reach * np.sqrt(rng.uniform(0, 1, count)), rng.uniform(-np.pi, np.pi, count))
