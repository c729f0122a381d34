"""Elements of the group of the regular octagon beside the cells of hypertiling: `python benchmarks/elements.py`.

orbiframe makes every element with its isometry, its parent and the letter that leads to it, so that words can be read
off; hypertiling (`pip install hypertiling`) makes the cells of {8,8} with their centres and corners. Both count
seconds of wall time on one core with all code loaded; the best of several runs. Prints a table, or JSON with `--json`.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import argparse
import json
import time
from collections.abc import Callable, Sized
from functools import partial

from orbiframe_geometries.h2 import H2
from orbiframe_invariants.word_growth import elements_by_length

from orbiframe import Word
from orbiframe.groups import PolygonGroup, elements_within, regular_polygon

KERNELS = ("GRC", "GR")  # the others take minutes for {8,8}, or memory that no machine has


def best(make: Callable[[], Sized], runs: int) -> tuple[int, float]:
    """The number of things made and the shortest time of some runs, after one that loads the code."""
    make()
    seconds, count = float("inf"), 0
    for _ in range(runs):
        start = time.perf_counter()
        made = make()
        seconds, count = min(seconds, time.perf_counter() - start), len(made)
        del made
    return count, seconds


def ours(layers: int, runs: int) -> dict[str, tuple[int, float]]:
    """Elements by word length and, as many or so, by radius."""
    group = PolygonGroup(regular_polygon(H2(), Word.parse("abcdABCD")))
    radius = 1.95 * layers + 1.3
    return {
        f"orbiframe, words of up to {layers} letters": best(lambda: elements_by_length(group, layers), runs),
        f"orbiframe, within {radius:.3g} of the origin": best(lambda: elements_within(group, radius), runs),
    }


def theirs(layers: int, runs: int) -> dict[str, tuple[int, float]]:
    """The kernels of hypertiling that can do {8,8}; nothing where it is not installed."""
    try:
        from hypertiling import HyperbolicTiling
    except ImportError:
        print("hypertiling cannot be imported, so that there is nothing to compare with: pip install hypertiling")
        return {}
    cells = {name: partial(HyperbolicTiling, 8, 8, layers + 1, kernel=name) for name in KERNELS}
    return {f"hypertiling {name}": best(make, runs) for name, make in cells.items()}


def main() -> None:
    """Time both and print the rates and the ratio to the best kernel."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--layers", type=int, default=7, help="letters of a word, layers of cells")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    rows = {**ours(options.layers, options.runs), **theirs(options.layers, options.runs)}
    rates = {name: count / seconds for name, (count, seconds) in rows.items()}
    peer = max((rate for name, rate in rates.items() if name.startswith("hypertiling")), default=None)
    if options.json:
        print(json.dumps({"per_second": rates, "best_peer": peer}))
        return
    for name, (count, _) in rows.items():
        ratio = "" if peer is None else f"{rates[name] / peer:8.2f}"
        print(f"{name:42} {count:10,} {rates[name] / 1e6:8.2f} M/s {ratio}")


if __name__ == "__main__":
    main()
