"""Claims of speed in the docs, beside their peers in one run: `python benchmarks/claims.py`; `--page` writes a page.

A claim is a ratio of processor seconds on one core, the peer's over ours, each the least of a few trials that take
turns, so that the load of the machine counts for both. Where a peer is faster the claim is by how much at most. A peer
that is not installed is told and left out. Exit status 1 where a claim does not hold.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("ORBIFRAME_THREADS", "1")

import argparse
import platform
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import file_claims
import fit_claims
import map_claims
import numpy as np
import spline_speed_claims
from claim import Action, Claim

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "speed.md"
# So many trials, and no more once they have taken so many seconds.
_TRIALS, _LONG = 3, 6.0


class Found(NamedTuple):
    """A claim with the processor seconds of both."""

    claim: Claim
    ours: float
    theirs: float

    @property
    def ratio(self) -> float:
        """How many times as fast ours is."""
        return self.theirs / self.ours

    @property
    def holds(self) -> bool:
        """Whether the claim does."""
        return self.ratio >= self.claim.least


CLAIMS = (*fit_claims.CLAIMS, *map_claims.CLAIMS, *spline_speed_claims.CLAIMS, *file_claims.CLAIMS)


def measured(claim: Claim) -> Found:
    """The least of some trials of each, in turn."""
    ours, theirs = claim.make()
    ours(), theirs()
    pairs = [(seconds(ours), seconds(theirs))]
    while len(pairs) < _TRIALS and np.sum(pairs) < _LONG:
        pairs.append((seconds(ours), seconds(theirs)))
    return Found(claim, *np.min(pairs, axis=0).tolist())


def seconds(action: Action) -> float:
    """Processor seconds of an action, and of the processes that it starts."""
    start = time.process_time() + _of_others()
    action()
    return time.process_time() + _of_others() - start


def _of_others() -> float:
    """Processor seconds of all processes that were started and have ended."""
    if sys.platform == "win32":
        return 0.0
    import resource

    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


def looked_at(word: str) -> Iterator[Found]:
    """The claims with a word in their name, measured one after the other and told."""
    for claim in CLAIMS:
        if word not in claim.what + claim.peer:
            continue
        try:
            found = measured(claim)
        except ImportError as error:
            print(f"no peer  {claim.what}, beside {claim.peer}: {error}", flush=True)
            continue
        sign = "holds" if found.holds else "FAILS"
        print(f"{sign}  {found.ratio:7.2f} of {claim.least:.2g}  {claim.what}, beside {claim.peer}", flush=True)
        yield found


def table(found: list[Found]) -> Iterator[str]:
    """The rows of the page."""
    yield "| what | beside | milliseconds | theirs | ratio | claimed | said in |\n|---|---|---|---|---|---|---|"
    for claim, ours, theirs in found:
        numbers = f"{1000 * ours:.1f} | {1000 * theirs:.1f} | {theirs / ours:.3g} | {claim.least:.2g}"
        yield f"| {claim.what} | {claim.peer} | {numbers} | {claim.where} |"


def page(found: list[Found]) -> str:
    """The page of the docs."""
    return (
        f"# Speed, beside others\n\nProcessor time of one core of {machine()}, Python {platform.python_version()},\n"
        f"the least of {_TRIALS} trials that take turns, fewer where they are long, with all code loaded; made by\n"
        "`python benchmarks/claims.py --page`, which fails where a ratio is less than what is claimed. Below 1 a peer\n"
        "is faster, and the claim is by how much at most.\n\n" + "\n".join(table(found)) + "\n"
    )


def machine() -> str:
    """The processor, as the system names it, and how many cores of it there are."""
    cores, info = os.cpu_count(), Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()} with {cores} cores, shared with other work"


def main() -> int:
    """Measure, print, and say whether all holds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--page", action="store_true", help=f"write {PAGE.name}")
    parser.add_argument("--only", default="", help="claims with this in their name")
    arguments = parser.parse_args()
    found = list(looked_at(arguments.only))
    if arguments.page:
        PAGE.write_text(page(found), encoding="utf-8")
    return int(not all(one.holds for one in found))


if __name__ == "__main__":
    sys.exit(main())
