"""Smoothing by cross-validation beside the best choice, bars beside the truth, robust fits beside plain ones.

Run `python benchmarks/smoothing.py [SEEDS]`; on the sphere of `benchmarks/fields.py`.
"""

from __future__ import annotations

import sys

import numpy as np
from fields import smooth, sphere, uniform
from orbiframe_fitters.robust import Robust
from orbiframe_fitters.smoothing import Smoothing

from orbiframe import Config, OrbifoldSurface, Registry, fit
from orbiframe.surfaces import nearest_points

DATA, MANY = 500, 2000
LADDER = 10.0 ** np.arange(-4, 4, 0.5)
BAR = 1.96


def surface() -> OrbifoldSurface:
    """The sphere in some 1,000 functions."""
    config = Config.load(overrides=["basis.name=ps6", "basis.size=1000"])
    return fit(sphere(), config, Registry.discover()).surface


def main(seeds: int) -> None:
    """One line for each noise: the error by cross-validation against the least, and how much of the truth bars hold."""
    made, there = surface(), uniform(MANY, 1)
    wanted, places = smooth(there), nearest_points(made, there)[0]
    for noise in (0.01, 0.05, 0.2):
        ratios, held = [], []
        for seed in range(seeds):
            x = uniform(DATA, 10 + seed)
            points = nearest_points(made, x)[0]
            values = smooth(x) + noise * np.random.default_rng(seed).normal(size=DATA)
            fields = [made.fit_field(points, values, fitter=Smoothing(fairing=f)) for f in LADDER]
            best = min(np.mean((field.evaluate(places)[:, 0] - wanted) ** 2) for field in fields)
            ours = made.fit_field(points, values)
            off = ours.evaluate(places)[:, 0] - wanted
            ratios.append(float(np.sqrt(np.mean(off**2) / best)))
            held.append(float(np.mean(np.abs(off) < BAR * ours.standard_error(places)[:, 0])))
        told = f"at most {max(ratios):.3f} times the least error, mean {np.mean(ratios):.3f}"
        print(f"noise {noise:<5} {told}; bars hold {100 * np.mean(held):.1f} %")
    x = uniform(DATA, 10)
    points, rng = nearest_points(made, x)[0], np.random.default_rng(0)
    good = smooth(x) + 0.05 * rng.normal(size=DATA)
    bad, spoilt = rng.choice(DATA, DATA // 10, replace=False), good.copy()
    spoilt[bad] += 3 * rng.choice([-1, 1], len(bad))
    for name, values, fitter in (
        ("without outliers", good, Smoothing()),
        ("a tenth outliers, smoothing", spoilt, Smoothing()),
        ("a tenth outliers, robust", spoilt, Robust()),
    ):
        field = made.fit_field(points, values, fitter=fitter)
        off = field.evaluate(places)[:, 0] - wanted
        named = "" if field.outliers is None else f", {len(field.outliers)} named of {len(bad)}"
        print(f"{name:<28} error {np.sqrt(np.mean(off**2)):.1e}{named}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 4)
