"""What a file of the corpus must get, and words that go into files of every text format."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

Faces = list[list[int]]
Points = list[list[float]]

CORNERS: Points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
TETRAHEDRON: Faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


@dataclass(frozen=True)
class Mesh:
    """The file is readable: these points and faces. warned: a warning goes with it."""

    points: Points
    faces: Faces
    warned: bool = False


@dataclass(frozen=True)
class Refused:
    """The file is damaged: an error with the file and these words, a regular expression."""

    words: str


@dataclass(frozen=True)
class Case:
    """A file with its answer."""

    name: str
    content: bytes
    answer: Mesh | Refused


GOOD = Mesh(CORNERS, TETRAHEDRON)


Rows = Iterator[tuple[str, str | bytes, Mesh | str]]


def named(suffix: str, rows: list[tuple[str, str | bytes, Mesh | str]]) -> Rows:
    for name, content, answer in rows:
        yield f"{name}.{suffix}", content, answer


# A word that is no finite decimal number, and may stand in any text format.
NO_NUMBERS = {
    "nan": "nan",
    "minus nan": "-nan(ind)",
    "inf": "inf",
    "infinity": "-Infinity",
    "too large": "1e400",
    "hexadecimal": "0x1p3",
    "hexadecimal integer": "0x10",
    "fortran": "1d3",
    "fortran without letter": "1.5-3",
    "comma": "1,5",
    "underscore": "1_000",
    "two signs": "+-1",
    "two points": "1.2.3",
    "only a sign": "-",
    "only a point": ".",
    "no exponent": "1e",
    "letters": "one",
    "full-width digit": "１",
    "unit": "1mm",
    "imaginary": "1j",
    "c suffix": "1.0f",
    "microsoft": "1.#INF",
    # A pattern that goes back over its digits would take many minutes.
    "very long": "9" * 200_000 + "x",
}
# Spellings of the number one.
ONES = [
    "+1",
    "1.",
    "1.0e0",
    "1E+00",
    "10e-1",
    "0.1e1",
    "01",
    "1." + "0" * 400,
    "0." + "0" * 300 + "1e301",
    "1" + "0" * 30 + "e-30",
]
