"""Surface nets: quadrilateral meshes whose vertices lie on the level set of a field."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron

Floats = NDArray[np.float64]


def surface_net(value_at: Callable[[Floats], Floats], low: Floats, high: Floats, step: float) -> Polyhedron:
    """A vertex in every cell of a grid that the zero set meets, a quadrilateral about every edge that crosses it."""
    axes = [np.arange(a, b + step, step) for a, b in zip(low, high, strict=True)]
    place = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    value = np.stack([value_at(plane.reshape(-1, 3)).reshape(plane.shape[:-1]) for plane in place])
    total, count = np.zeros(place.shape), np.zeros(value.shape)
    rings = []
    for axis in range(3):
        crossed = np.argwhere(np.diff(value < 0, axis=axis))
        ahead = crossed + np.eye(3, dtype=int)[axis]
        a, b = value[tuple(crossed.T)], value[tuple(ahead.T)]
        where = place[tuple(crossed.T)]
        where[:, axis] += step * a / (a - b)
        back = np.zeros((4, 3), dtype=int)
        back[[0, 3], (axis + 1) % 3], back[[0, 1], (axis + 2) % 3] = 1, 1
        ring = crossed[:, None] - back
        ring[a > 0] = ring[a > 0][:, ::-1]
        np.add.at(total, tuple(ring.reshape(-1, 3).T), np.repeat(where, 4, axis=0))
        np.add.at(count, tuple(ring.reshape(-1, 3).T), 1)
        rings.append(ring)
    met = count > 0
    number = np.full(value.shape, -1)
    number[met] = np.arange(met.sum())
    faces = number[tuple(np.concatenate(rings).reshape(-1, 3).T)].reshape(-1, 4)
    return Polyhedron.from_faces(total[met] / count[met][:, None], faces)
