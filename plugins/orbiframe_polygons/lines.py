"""Lines: numbers and faces as text, the fewest digits that give the same numbers again."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe_polygons.powers import powers_of_ten

Array = NDArray[Any]
Ints = NDArray[np.intp]

# From so many numbers on, compiled loops gain more time than the import of the compiler takes.
LARGE = 2**19
BLOCK = 2**14


@dataclass(frozen=True, slots=True)
class Rows:
    """Rows of text: a lead, whole numbers with a blank before each, then columns with `glue` before, between and after.

    columns: arrays (n,) of floats or of whole numbers from 0; glue: one more than the columns; offsets, numbers: the
    whole numbers of row k are numbers[offsets[k]:offsets[k + 1]]; lead None: how many these are; twice: written k//k.
    """

    columns: Sequence[Array]
    glue: Sequence[str]
    offsets: Ints
    numbers: Ints
    lead: str | None = ""
    twice: bool = False

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def text(self) -> Iterator[bytes]:
        """The text in blocks of some thousand rows, each float as Python writes it."""
        large = len(self.numbers) + len(self.columns) * len(self) >= LARGE
        for first in range(0, len(self), BLOCK):
            block = self.part(first, min(first + BLOCK, len(self)))
            yield block.compiled() if large else block.plain()

    def part(self, first: int, last: int) -> Rows:
        """The rows first to last - 1."""
        offsets = self.offsets[first : last + 1]
        numbers = self.numbers[offsets[0] : offsets[-1]]
        return replace(
            self, columns=[c[first:last] for c in self.columns], offsets=offsets - offsets[0], numbers=numbers
        )

    def plain(self) -> bytes:
        """The text, by Python alone."""
        words = list(map(" {0}//{0}".format if self.twice else " {}".format, self.numbers.tolist()))
        rows = ["".join(words[a:b]) for a, b in pairwise(self.offsets.tolist())]
        leads = map(str, np.diff(self.offsets).tolist()) if self.lead is None else [self.lead] * len(self)
        parts: list[Iterable[str]] = [leads, rows]
        for glue, column in zip(self.glue, self.columns, strict=False):
            parts += [[glue] * len(self), map(repr, column.tolist())]
        return "".join(map("".join, zip(*parts, [self.glue[-1]] * len(self), strict=True))).encode("ascii")

    def compiled(self) -> bytes:
        """The same text, by compiled loops."""
        from orbiframe_polygons.compiled_rows import WIDEST, put_rows

        whole = np.array([c.dtype.kind in "iu" for c in self.columns], dtype=np.bool_)
        columns = [_bits(column) for column in self.columns]
        bits = np.stack(columns, axis=1) if columns else np.empty((len(self), 0), dtype=np.uint64)
        glue, lead = (np.frombuffer("".join(s).encode("ascii"), np.uint8) for s in (self.glue, self.lead or ""))
        glued = np.cumsum([0, *map(len, self.glue)])
        width = len(lead) + WIDEST * (1 + len(columns)) + len(glue)
        out = np.empty(len(self) * width + 2 * WIDEST * len(self.numbers), dtype=np.uint8)
        put = (self.lead is None, self.twice, self.offsets, self.numbers, glue, glued, bits, whole)
        return out[: put_rows(out, powers_of_ten(rounded_up=True), lead, *put)].tobytes()


def _bits(column: Array) -> NDArray[np.uint64]:
    return column.astype(np.uint64) if column.dtype.kind in "iu" else column.astype(np.float64).view(np.uint64)


def table_text(columns: Sequence[Array], *, start: str = "") -> Iterator[bytes]:
    """One line for each row of a table given by its columns: the start, then the numbers with blanks between."""
    glue = [start, *[" "] * (len(columns) - 1), "\n"]
    return shaped_text(columns, glue)


def shaped_text(columns: Sequence[Array], glue: Sequence[str]) -> Iterator[bytes]:
    """The rows of a table given by its columns, with pieces of text before, between and after the numbers."""
    return Rows(columns, glue, np.zeros(len(columns[0]) + 1, dtype=np.intp), np.empty(0, dtype=np.intp)).text()


def faces_text(
    polyhedron: Polyhedron,
    columns: Sequence[Array] = (),
    *,
    lead: str | None = None,
    first: int = 0,
    twice: bool = False,
) -> Iterator[bytes]:
    """One line for each face: the lead or the number of corners, the corners, and a row of more columns.

    first: the index of the first vertex; twice: each corner as k//k.
    """
    glue = [*[" "] * len(columns), "\n"]
    return Rows(columns, glue, polyhedron.offsets, polyhedron.tail + first, lead, twice).text()


def columns_of(*tables: NDArray[np.float64] | None) -> list[Array]:
    """The columns of those tables that are there, in order."""
    return [column for table in tables if table is not None for column in table.T]


def save(path: Path, lines: Sequence[str], *parts: Iterable[bytes]) -> None:
    """Write lines, and text after them; all lines end with LF, on every system."""
    with path.open("wb") as file:
        file.write("\n".join([*lines, ""]).encode("ascii"))
        for part in parts:
            file.writelines(part)
