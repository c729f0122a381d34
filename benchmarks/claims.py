"""Claims of speed in the docs, beside their peers in one run: `python benchmarks/claims.py`; `--page` writes a page.

A claim is a ratio of processor seconds on one core, the peer's over ours, each the least of a few trials that take
turns, so that the load of the machine counts for both. Exit status 1 where a claim does not hold.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("ORBIFRAME_THREADS", "1")

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import map as maps
import numpy as np
from numpy.typing import NDArray
from orbiframe_fitters.coupled import PackedBlocks
from orbiframe_parametrizers.elimination import Elimination, elimination_order, factorised
from scipy.sparse.linalg import splu

from orbiframe import OrbifoldSurface, Polyhedron, fit
from orbiframe.meshes.triangle_boxes import _turned

Floats = NDArray[np.float64]
Action = Callable[[], object]

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "speed.md"
_TRIALS = 3
_MAP = "[speed of the map](map_speed.md)"
_SIZE = "[size and fairing](../how_to/choose_size_and_fairing.md)"


class Claim(NamedTuple):
    """What is measured, beside what, how many times as fast ours is said to be at least, and where that is said."""

    what: str
    peer: str
    least: float
    where: str
    make: Callable[[], tuple[Action, Action]]


class Found(NamedTuple):
    """A claim with the processor seconds of both."""

    claim: Claim
    ours: float
    theirs: float

    @property
    def ratio(self) -> float:
        """How many times as fast ours is."""
        return self.theirs / self.ours


@cache
def mesh() -> Polyhedron:
    """A plate of genus 2 and some 30,000 vertices."""
    return maps.plate(2, 30_000)


@cache
def surface() -> OrbifoldSurface:
    """A linear fit of it."""
    return fit(mesh(), size=500, fast=True, progress=False).surface


def boxes() -> tuple[Action, Action]:
    """Boxes turned along triangles, by compiled code and by numpy's eigenvectors."""
    corners = mesh().vertices[mesh().triangles]
    leaves = np.repeat(corners, 4, axis=0).reshape(-1, 12, 3)

    def with_numpy() -> object:
        away = leaves - leaves.mean(axis=1, keepdims=True)
        axes = np.linalg.eigh(np.swapaxes(away, 1, 2) @ away)[1]
        along = leaves @ axes
        return along.min(axis=1), along.max(axis=1)

    return lambda: _turned(leaves), with_numpy


def jets() -> tuple[Action, Action]:
    """Values and derivatives of a surface at points, summed up in one pass, and by sparse matrices."""
    basis, coefficients, points = surface().basis, surface().coefficients, surface().triangulation
    places = points.locate(np.arange(points.polyhedron.face_count), np.full((points.polyhedron.face_count, 3), 1 / 3))
    return (
        lambda: basis.jets(places, coefficients, 2),  # type: ignore[attr-defined]
        lambda: [matrix @ coefficients for matrix in basis.jet_matrices(places, 2)],  # type: ignore[attr-defined]
    )


def factors() -> tuple[Action, Action]:
    """The order and the factors of a matrix on the edges of a mesh, and scipy's splu as it comes."""
    large = maps.plate(2, 100_000)
    tail, head = large.tail[large.representative], large.head[large.representative]
    degree = np.bincount(tail, minlength=len(large.vertices)) + np.bincount(head, minlength=len(large.vertices))
    entries, diagonal = -np.ones(len(tail)), degree + 0.01
    plain = Elimination(np.arange(len(degree)), np.arange(len(degree))).matrix(tail, head, entries, diagonal)

    def ours() -> object:
        order = elimination_order(len(degree), tail, head)
        return factorised(Elimination(order, np.argsort(order)).matrix(tail, head, entries, diagonal))

    return ours, lambda: splu(plain)


def packed() -> tuple[Action, Action]:
    """The product of a step of a sliding fit: packed entries, and nine dense blocks."""
    size, rng = 1500, np.random.default_rng(0)
    near = np.abs(np.subtract.outer(np.arange(size), np.arange(size))) < size * 0.06
    upper = np.triu(near)[:, :, None] * rng.standard_normal((size, size, 6))
    matrix, x = PackedBlocks.of(upper, np.zeros((size, size))), rng.standard_normal((size, 3))
    blocks = [[upper[:, :, k] + upper[:, :, k].T for k in line] for line in ((0, 1, 2), (1, 3, 4), (2, 4, 5))]
    return lambda: matrix.image(x), lambda: [sum(block @ x[:, b] for b, block in enumerate(line)) for line in blocks]


def linear() -> tuple[Action, Action]:
    """`--fast` beside the default."""
    return (
        lambda: fit("dataset:plate_genus2", size=500, fast=True, progress=False),
        lambda: fit("dataset:plate_genus2", size=500, progress=False),
    )


CLAIMS = (
    Claim("boxes of triangles", "`numpy.linalg.eigh`", 5.0, "decision 45", boxes),
    Claim("derivatives of a surface up to the second", "sparse matrices", 1.2, "changelog", jets),
    Claim(
        "order and factors of one matrix, 101,248 vertices",
        "`scipy.sparse.linalg.splu`",
        1.3,
        _MAP,
        factors,
    ),
    Claim("product in a step of a sliding fit", "nine dense blocks", 3.0, "decision 45", packed),
    Claim("`--fast`", "the default fit", 2.0, _SIZE, linear),
)


def measured(claim: Claim) -> Found:
    """The least of some trials of each, in turn."""
    ours, theirs = claim.make()
    ours(), theirs()
    pairs = [(seconds(ours), seconds(theirs)) for _ in range(_TRIALS)]
    return Found(claim, *np.min(pairs, axis=0).tolist())


def seconds(action: Action) -> float:
    """Processor seconds of an action."""
    start = time.process_time()
    action()
    return time.process_time() - start


def table(found: list[Found]) -> Iterator[str]:
    """The rows of the page."""
    yield "| what | beside | milliseconds | theirs | ratio | claimed | said in |\n|---|---|---|---|---|---|---|"
    for claim, ours, theirs in found:
        numbers = f"{1000 * ours:.1f} | {1000 * theirs:.1f} | {theirs / ours:.1f} | {claim.least:g}"
        yield f"| {claim.what} | {claim.peer} | {numbers} | {claim.where} |"


def page(found: list[Found]) -> str:
    """The page of the docs."""
    return (
        "# Speed, beside others\n\nProcessor time of one core, the least of three trials that take turns, with all "
        "code loaded;\nmade by `python benchmarks/claims.py --page`, which fails where a ratio is less than what is "
        "claimed.\n\n" + "\n".join(table(found)) + "\n"
    )


def main() -> int:
    """Measure, print, and say whether all holds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--page", action="store_true", help=f"write {PAGE.name}")
    arguments = parser.parse_args()
    found = []
    for claim in CLAIMS:
        found.append(measured(claim))
        sign = "holds" if found[-1].ratio >= claim.least else "FAILS"
        print(f"{sign}  {found[-1].ratio:6.1f} of {claim.least:g}  {claim.what}, beside {claim.peer}", flush=True)
    if arguments.page:
        PAGE.write_text(page(found), encoding="utf-8")
    return int(any(one.ratio < one.claim.least for one in found))


if __name__ == "__main__":
    sys.exit(main())
