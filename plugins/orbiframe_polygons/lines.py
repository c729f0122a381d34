"""Lines: numbers and faces as text, the fewest digits that give the same numbers again."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron

Floats = NDArray[np.float64]


def rows(table: Floats) -> Iterator[str]:
    """Every row of a table (n, k) as text, each number with the fewest digits that give the same float64 again."""
    return map(" ".join, zip(*[map(repr, column) for column in table.T.tolist()], strict=True))


def face_lines(polyhedron: Polyhedron) -> Iterator[str]:
    """Every face as text: how many corners, then the corners."""
    words = list(map(str, polyhedron.tail.tolist()))
    offsets = polyhedron.offsets.tolist()
    return (f"{b - a} {' '.join(words[a:b])}" for a, b in pairwise(offsets))


def joined(lines: Iterable[str], more: Floats | None) -> Iterable[str]:
    """The lines, each with the numbers of one row of a table after it."""
    return lines if more is None else map(" ".join, zip(lines, rows(more), strict=True))


def save(path: Path, lines: Iterable[str]) -> None:
    """Write lines that end with LF, on every system."""
    path.write_bytes("\n".join([*lines, ""]).encode("ascii"))
