"""The plane of a face, across its vector area."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def in_its_plane(points: Floats) -> Floats:
    """The corners (n, 3) of a face in coordinates of the plane across its vector area, (n, 2), counterclockwise.

    Of unit size, about the middle. Sums are written out: a library's product may round in another way elsewhere.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    size = float((high / 2 - low / 2).max()) or 1.0
    p = (points - (low / 2 + high / 2)) / size
    n = np.cross(p, np.roll(p, -1, axis=0)).sum(axis=0)
    length = float(np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]))
    n = n / length if length > 0 else np.array([0.0, 0.0, 1.0])
    u = np.cross(np.eye(3)[np.argmin(np.abs(n))], n)
    u /= np.sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2])
    v = np.cross(n, u)
    return np.stack([p[:, 0] * a[0] + p[:, 1] * a[1] + p[:, 2] * a[2] for a in (u, v)], axis=1)
