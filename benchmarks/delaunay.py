"""Delaunay triangulations of X/H beside scipy's of the plane: `python benchmarks/delaunay.py`, process time a point."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from lifted_sites import group_of
from scipy.spatial import Delaunay

from orbiframe.delaunay import delaunay, polygon_triangulation, uniform_points

SURFACES = {"sphere": "aA", "torus": "abAB", "Klein bottle": "abaB", "genus 2": "abcdABCD", "3 crosscaps": "aabbcc"}


def microseconds(work: Callable[[], object], count: int) -> float:
    """The best of three runs."""
    best = np.inf
    for _ in range(3):
        start = time.process_time()
        work()
        best = min(best, time.process_time() - start)
    return 1e6 * best / count


def main() -> None:
    """One line for every surface and number of points."""
    print("surface        points   µs a point   scipy, plane   ratio")
    for name, word in SURFACES.items():
        start = polygon_triangulation(group_of(word))
        delaunay(start, uniform_points(start, 100))
        for count in (1_000, 10_000, 100_000):
            sites, plane = uniform_points(start, count), np.random.default_rng(0).random((count, 2))
            ours = microseconds(lambda s=sites, t=start: delaunay(t, s), count)
            theirs = microseconds(lambda p=plane: Delaunay(p), count)
            print(f"{name:13} {count:7} {ours:12.1f} {theirs:14.1f} {ours / theirs:7.2f}", flush=True)


if __name__ == "__main__":
    main()
