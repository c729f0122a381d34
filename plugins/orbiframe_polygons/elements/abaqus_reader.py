"""Abaqus reader: shell elements of an input file, parts at the places of their instances."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.elements.abaqus_keywords import HARMLESS, MESH
from orbiframe_polygons.elements.numbered import Numbered, tell_passed
from orbiframe_polygons.faces import whole
from orbiframe_polygons.parts import Part, polyhedron_of, rotation
from orbiframe_polygons.room import Budget
from orbiframe_polygons.text import Text, named, plain, shown, table

Floats = NDArray[np.float64]

# A line that starts with one star; two begin a comment.
KEYWORD = re.compile(rb"^[ \t]*\*(?!\*)[^\n]*", re.MULTILINE)
COMMENT = re.compile(rb"^[ \t]*\*\*[^\n]*", re.MULTILINE)
FACE = re.compile(
    r"(?:S|STRI|R3D|SFM3D|M3D|DS|CPS|CPE|CPEG|CAX|CGAX|DC2D|DCAX|AC2D|ACAX|F2D|F3D|FAX)([34])(?:[A-Z][A-Z0-9]*)?"
)
SOLID = re.compile(r"(?:C3D|DC3D|AC3D|Q3D|SC|CSS|COH3D|EC3D|PC3D|GK3D|CCL)\d.*")
BELOW = re.compile(
    r"(?:T2D|T3D|B2|B3|PIPE|R2D2|RB2D2|RB3D2|RAX2|ELBOW|FRAME|SAX|MASS|ROTARYI|HEATCAP|SPRING|DASHPOT|CONN|GAP|DCOUP|"
    r"JOINTC|ITT|ITS|DC1D|AC1D|F2D2|FAX2|CONN2D|CONN3D|DISTRIBUTING|SFMAX|MAX|COH2D|COHAX|GK|TSHAFT).*"
)
# Parameters that do not change what the data lines say.
ALLOWED = {
    "NODE": {"NSET", "SYSTEM"},
    "ELEMENT": {"TYPE", "ELSET", "SOLID ELEMENT NUMBERING"},
    "PART": {"NAME"},
    "INSTANCE": {"NAME", "PART"},
    "ASSEMBLY": {"NAME"},
}


@dataclass(frozen=True, slots=True)
class Card:
    """A keyword with its parameters, and the bytes of its data lines; line: of the keyword; first: of the data."""

    name: str
    parameters: dict[str, str]
    line: int
    data: bytes
    first: int


def read(path: Path) -> Polyhedron:
    """The triangles and quadrilaterals of an Abaqus input file, each part once for each of its instances.

    Lines, points and solids are passed over with a warning, as long as there are faces. Raises FormatError, by name,
    for every keyword that is not known or changes others (INCLUDE, SYSTEM, NGEN, ELGEN and more), for nodes in other
    systems of coordinates or in other files, and for elements of the second order.

    Source: Dassault Systèmes, Abaqus Keywords Reference Guide.
    """
    model = _Model(path)
    for card in cards(path, plain(path, path.read_bytes())):
        model.take(card)
    return polyhedron_of(model.parts())


def cards(path: Path, text: bytes) -> Iterator[Card]:
    """The keywords of a text with their data lines."""
    text = COMMENT.sub(b"", text)
    found = list(KEYWORD.finditer(text))
    head = text[: found[0].start()] if found else text
    if head.strip():
        raise FormatError(f"{path}, line 1: found {shown(head.split()[0])}, but a keyword such as *NODE is required")
    line, at, k = 1, 0, 0
    while k < len(found):
        start, end = found[k].span()
        words = [found[k][0]]
        while words[-1].rstrip().endswith(b","):  # the keyword goes on in the next line
            after = text.find(b"\n", end + 1)
            after = len(text) if after < 0 else after
            if end >= len(text) or (k + 1 < len(found) and found[k + 1].start() < after):
                break
            words.append(text[end + 1 : after])
            end = after
        stop = found[k + 1].start() if k + 1 < len(found) else len(text)
        line += text.count(b"\n", at, start)
        at = start
        first = line + text.count(b"\n", start, end)
        yield _card(path, b" ".join(words), line, text[end:stop], first)
        k += 1


def _card(path: Path, words: bytes, line: int, data: bytes, first: int) -> Card:
    name, *rest = words.decode("utf-8", errors="replace").strip().rstrip(",").split(",")
    parameters: dict[str, str] = {}
    for word in rest:
        key, _, value = word.partition("=")
        key = " ".join(key.split()).upper()
        if key in parameters:
            raise FormatError(f"{path}, line {line}: the parameter {shown(key.encode())} stands twice")
        parameters[key] = value.strip().strip('"')
    return Card(" ".join(name[1:].split()).upper(), parameters, line, data, first)


@dataclass(frozen=True, slots=True)
class Placement:
    """An instance: its part, its own nodes and elements, and how it is turned and moved."""

    part: str
    own: Numbered
    turn: Floats
    shift: Floats


@dataclass(slots=True)
class _Model:
    """What is met on the way through the file; the nodes and elements go where the file is at the moment."""

    path: Path
    _flat: Numbered = field(init=False)
    _parts: dict[str, Numbered] = field(default_factory=dict)
    _placed: list[Placement] = field(default_factory=list)
    _now: Numbered = field(init=False)
    _inside: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._flat = self._now = Numbered(self.path)

    def take(self, card: Card) -> None:
        """Obey a keyword, pass over one that leaves the mesh as it is, refuse all others."""
        if card.name not in MESH:
            if card.name not in HARMLESS:
                self._refuse(card, "this keyword is not known, or changes what others mean; it is not read")
            return
        wrong = card.parameters.keys() - ALLOWED.get(card.name, set())
        if wrong:
            self._refuse(card, f"the parameter {shown(min(wrong).encode())} is not read")
        getattr(self, f"_{card.name.lower().replace(' ', '_')}")(card)

    def parts(self) -> list[Part]:
        """The faces of all instances, or of the whole file where it has no parts."""
        if self._inside:
            raise FormatError(f"{self.path}: the file ends inside *{self._inside[-1]}; is it cut short?")
        blocks = [self._flat, *self._parts.values(), *(p.own for p in self._placed)]
        if len(self._parts) > 1 and not self._placed:
            raise FormatError(f"{self.path}: there are {len(self._parts)} parts, but no *INSTANCE that places them")
        tell_passed(self.path, blocks)
        if self._placed:
            made = list(self._instances())
        else:
            made = [block.part() for block in self._parts.values() if not block.is_empty]
        return [*([] if self._flat.is_empty else [self._flat.part()]), *made]

    def _instances(self) -> Iterator[Part]:
        made = {name: block.part() for name, block in self._parts.items() if not block.is_empty}
        budget = Budget(self.path, "its instances repeat their parts")
        for placed in self._placed:
            both = [part for part in (made.get(placed.part), _own(placed.own)) if part is not None]
            budget.spend(1 + sum(len(part.points) + len(part.tail) for part in both))
            yield from (part.moved(placed.turn, placed.shift) for part in both)

    # ---- keywords ---------------------------------------------------------------------------------------------------

    def _part(self, card: Card) -> None:
        name = self._named(card, "NAME")
        if name in self._parts or self._inside:
            self._refuse(card, "the part is there already, or stands inside something else")
        self._now = self._parts[name] = Numbered(self.path)
        self._inside.append("PART")

    def _assembly(self, card: Card) -> None:
        if self._inside:
            self._refuse(card, f"it stands inside *{self._inside[-1]}")
        self._inside.append("ASSEMBLY")

    def _instance(self, card: Card) -> None:
        if self._inside != ["ASSEMBLY"]:
            self._refuse(card, "an instance stands inside *ASSEMBLY only")
        part = self._named(card, "PART")
        if part not in self._parts:
            self._refuse(card, f"there is no part {shown(part.encode())}")
        placed = Placement(part, Numbered(self.path), *self._place(card))
        self._placed.append(placed)
        self._now = placed.own
        self._inside.append("INSTANCE")

    def _end_part(self, card: Card) -> None:
        self._leave(card, "PART")

    def _end_instance(self, card: Card) -> None:
        self._leave(card, "INSTANCE")

    def _end_assembly(self, card: Card) -> None:
        self._leave(card, "ASSEMBLY")

    def _leave(self, card: Card, name: str) -> None:
        if self._inside[-1:] != [name]:
            self._refuse(card, f"there is no *{name} to end here")
        self._inside.pop()
        self._now = self._flat

    def _node(self, card: Card) -> None:
        if card.parameters.get("SYSTEM", "R").upper() != "R":
            self._refuse(card, f"nodes with SYSTEM={card.parameters['SYSTEM'][:20]} are not read; write X, Y, Z")
        text = self._table(card)
        if (text.words > 7).any():
            row = int((text.words > 7).argmax())
            text.refuse(row, f"found {text.words[row]} numbers, but a node has its number and three coordinates")
        values, first = text.numbers(), text.first
        numbers = whole(values[first], lambda row: f"{self.path}, line {text.number[row]}")
        # What is left out at the end of a line is 0.
        padded = np.append(values, 0.0)
        columns = [padded[np.where(text.words > k, first + k, len(values))] for k in (1, 2, 3)]
        self._now.add_nodes(numbers, np.stack(columns, axis=1))

    def _element(self, card: Card) -> None:
        kind = self._named(card, "TYPE")
        face = FACE.fullmatch(kind)
        if face is not None:
            numbers = self._rows(card, 1 + int(face[1]))
            self._now.add_faces(numbers[:, 0], numbers[:, 1:])
        elif SOLID.fullmatch(kind) or BELOW.fullmatch(kind):
            lines = sum(bool(line.strip()) for line in card.data.split(b"\n"))
            self._now.skip(f"elements {kind[:20]}", lines, solid=SOLID.fullmatch(kind) is not None)
        else:
            self._refuse(card, f"elements of the type {kind[:20]!r} are not read; save S3 and S4")

    # ---- data lines -------------------------------------------------------------------------------------------------

    def _table(self, card: Card) -> Text:
        """The data lines of a keyword as a table of words."""
        data = re.sub(rb",[ \t]*(?=\n|$)", b"", card.data)
        empty = re.search(rb"(?:,|\n)[ \t]*,", data)
        if empty:
            line = card.first + data.count(b"\n", 0, empty.end())
            raise FormatError(f"{self.path}, line {line}: there is nothing between two commas; write the number")
        return table(self.path, data.replace(b",", b" "), line=card.first)

    def _rows(self, card: Card, width: int) -> NDArray[np.intp]:
        """The data lines as rows of whole numbers; a row may go on in further lines after a comma."""
        text = self._table(card)
        values = whole(text.numbers(), lambda k: f"{self.path}, line {_line(text, k)}")
        starts = np.arange(0, len(values), width)
        off = ~np.isin(starts, text.first)
        if len(values) % width or off.any():
            row = int((text.words != width).argmax())
            text.refuse(row, f"found {text.words[row]} numbers, but an element has its number and {width - 1} nodes")
        return values.reshape(-1, width)

    def _place(self, card: Card) -> tuple[Floats, Floats]:
        """The rotation and the translation of an instance: it is moved, then turned about an axis by degrees."""
        text = self._table(card)
        rows = [text.lines(k, k + 1).numbers() for k in range(len(text))]
        if [len(row) for row in rows] not in ([], [3], [3, 7]):
            self._refuse(card, "an instance has a line of 3 numbers, then one of 7 at most")
        shift = rows[0] if rows else np.zeros(3)
        if len(rows) < 2:
            return np.eye(3), shift
        start, axis, angle = rows[1][:3], rows[1][3:6] - rows[1][:3], np.deg2rad(rows[1][6])
        length = float(np.linalg.norm(axis))
        if not length:
            self._refuse(card, "the axis of the rotation has the length 0")
        turn = rotation(axis / length, float(angle))
        return turn, (shift - start) @ turn + start

    def _named(self, card: Card, key: str) -> str:
        name = card.parameters.get(key, "")
        if not name:
            self._refuse(card, f"the parameter {key} is required")
        return name.upper()

    def _refuse(self, card: Card, complaint: str) -> NoReturn:
        raise FormatError(f"{self.path}, line {card.line}: *{named(card.name)}: {complaint}")


def _own(block: Numbered) -> Part | None:
    return None if block.is_empty else block.part()


def _line(text: Text, word: int) -> int:
    return int(text.number[np.searchsorted(text.first, word, side="right") - 1])
