"""The start of the command line in seconds: `python benchmarks/start.py`.

The least and the median of some runs of `orbiframe --help` in processes of their own, beside a bare Python.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

RUNS = 20
COMMANDS = {"python -c pass": ["-c", "pass"], "orbiframe --help": ["-m", "orbiframe", "--help"]}


def seconds(arguments: list[str]) -> float:
    """How long one process takes."""
    start = time.perf_counter()
    subprocess.run([sys.executable, *arguments], capture_output=True, check=True)
    return time.perf_counter() - start


def main() -> None:
    """Measure and print."""
    for name, arguments in COMMANDS.items():
        found = [seconds(arguments) for _ in range(RUNS)]
        print(f"{name:18} least {min(found):.3f} s, median {statistics.median(found):.3f} s")


if __name__ == "__main__":
    main()
