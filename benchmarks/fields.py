"""Fields on the sphere beside scipy's thin plates: errors and speed. Run `python benchmarks/fields.py [DATA]`."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np
from scipy.interpolate import RBFInterpolator

from orbiframe import Config, Polyhedron, Registry, fit
from orbiframe.meshes import refine
from orbiframe.surfaces import nearest_points

MANY = 20_000
REPEATS = 3


def sphere() -> Polyhedron:
    """An octahedron cut fine and projected."""
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    fine = refine(Polyhedron.from_faces(corners, faces), 12).polyhedron
    return fine.with_vertices(fine.vertices / np.linalg.norm(fine.vertices, axis=1, keepdims=True))


def smooth(x: np.ndarray) -> np.ndarray:
    """What is to be found: two bumps and a wave."""
    bump, hole = np.array([0.6, 0.6, 0.529]), np.array([0, -0.8, -0.6])
    bumps = np.exp(-4 * ((x - bump) ** 2).sum(axis=1)) - np.exp(-6 * ((x - hole) ** 2).sum(axis=1))
    return np.asarray(bumps + 0.2 * np.sin(4 * x[:, 0] + x[:, 1]))


def uniform(count: int, seed: int) -> np.ndarray:
    """Points of the sphere, uniform in area."""
    x = np.random.default_rng(seed).normal(size=(count, 3))
    return np.asarray(x / np.linalg.norm(x, axis=1, keepdims=True))


def timed(work: Callable[[], np.ndarray]) -> tuple[np.ndarray, float]:
    """What comes out, and the least of some times."""
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        found = work()
        seconds.append(time.perf_counter() - start)
    return found, min(seconds)


def main(data: int) -> None:
    """One line for each: the relative error in the mean square, and how many points a second are evaluated."""
    x, there = uniform(data, 0), uniform(MANY, 1)
    wanted = smooth(there)
    config = Config.load(overrides=["basis.name=ps6", "basis.size=3000"])
    surface = fit(sphere(), config, Registry.discover()).surface
    start = time.perf_counter()
    field = surface.fit_field(x, smooth(x))
    made = time.perf_counter() - start
    points = nearest_points(surface, there)[0]
    ours, seconds = timed(lambda: field.evaluate(points)[:, 0])
    start = time.perf_counter()
    plates = RBFInterpolator(x, smooth(x), kernel="thin_plate_spline")
    built = time.perf_counter() - start
    theirs, slow = timed(lambda: plates(there))
    for name, found, spent, first in (("ps6, third order", ours, seconds, made), ("thin plate", theirs, slow, built)):
        error = np.sqrt(np.mean((found - wanted) ** 2) / np.mean(wanted**2))
        print(f"{name:<18} error {error:.1e}  {MANY / spent / 1e3:9.1f} thousand points/s  made in {first:.1f} s")
    ratio = np.sqrt(np.mean((theirs - wanted) ** 2) / np.mean((ours - wanted) ** 2))
    print(f"{ratio:.1f} times more accurate, {slow / seconds:.0f} times faster")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 2000)
