"""All laws of all bases on all surfaces of the datasets: `python benchmarks/laws.py [FAMILY ...]`.

A line for each pair, with the seconds and the laws that do not hold; the exit status is 1 if there is one.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from dataset_laws import FAMILIES, SURFACES, exists, verdicts


def main(families: list[str]) -> int:
    """Try all pairs; how many laws are broken."""
    broken = 0
    for family in families or FAMILIES:
        for surface in (s for s in SURFACES if exists(family, s)):
            start = time.perf_counter()
            with tempfile.TemporaryDirectory() as folder:
                found = [v for v in verdicts(family, surface, Path(folder)) if v.error is not None]
            broken += len(found)
            seconds = time.perf_counter() - start
            print(f"{family:16} {surface:18} {seconds:6.1f} s  {'all laws hold' if not found else ''}", flush=True)
            for verdict in found:
                print(f"    {verdict.law}: {verdict.error}")
    return broken


if __name__ == "__main__":
    sys.exit(min(main(sys.argv[1:]), 1))
