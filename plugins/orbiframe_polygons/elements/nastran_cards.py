"""Cards of Nastran: the lines of the bulk data as lists of fields, in fixed columns, long fields or between commas.

Source: MSC Nastran Quick Reference Guide, "Bulk Data Entries".
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from orbiframe import FormatError
from orbiframe_polygons.text import named, shown

REAL = re.compile(r"([+-]?(?:\d++\.?\d*+|\.\d++))(?:[dDeE]([+-]?\d++)|([+-]\d++))?", re.ASCII)
INTEGER = re.compile(r"[+-]?\d{1,15}", re.ASCII)
BULK = re.compile(r"BEGIN\s+BULK\b(.*)", re.IGNORECASE)
INCLUDE = re.compile(r"\s*INCLUDE\b", re.IGNORECASE)
# Columns of a line: the name, then fields of eight, or of sixteen.
SHORT = [(k, k + 8) for k in range(8, 72, 8)]
LONG = [(k, k + 16) for k in range(8, 72, 16)]


@dataclass(slots=True)
class Card:
    """A card: its name in capitals, and its fields after it."""

    path: Path
    name: str
    line: int
    fields: list[str]

    def integer(self, field: int, default: int | None = None) -> int:
        """A whole number; fields are counted from 1 after the name. Raises FormatError for anything else."""
        word = self.fields[field - 1] if field <= len(self.fields) else ""
        if not word and default is not None:
            return default
        if not INTEGER.fullmatch(word):
            self.refuse(f"found {shown(word.encode())} in field {field + 1}, but a whole number is required")
        return int(word)

    def real(self, field: int) -> float:
        """A number, 0 where the field is empty; the E of the exponent may be a D, or missing."""
        word = self.fields[field - 1] if field <= len(self.fields) else ""
        if not word:
            return 0.0
        found = REAL.fullmatch(word)
        if found is None:
            self.refuse(f"found {shown(word.encode())} in field {field + 1}, but a number is required")
        value = float(f"{found[1]}e{found[2] or found[3] or 0}")
        if not math.isfinite(value):
            self.refuse(f"found {shown(word.encode())} in field {field + 1}, but a finite number is required")
        return value

    def refuse(self, complaint: str) -> NoReturn:
        """Raise FormatError with the line and the name."""
        raise FormatError(f"{self.path}, line {self.line}: {named(self.name)}: {complaint}")


def cards(path: Path, text: str) -> Iterator[Card]:
    """The cards of the bulk data, up to ENDDATA. Raises FormatError for INCLUDE, and where ENDDATA is missing."""
    lines = _bulk(path, text)
    card: Card | None = None
    for number, line in lines:
        name, fields = _fields(line)
        if name.upper().strip() == "ENDDATA":
            if card is not None:
                yield card
            return
        if not name or name[0] in "+*":
            if card is None:
                raise FormatError(f"{path}, line {number}: found {shown(line.encode())}, which continues no card")
            _continue(card, fields)
            continue
        if card is not None:
            yield card
        card = Card(path, name.upper().rstrip("*").strip(), number, fields)
    raise FormatError(f"{path}, line {text.count(chr(10)) + 1}: the file ends without 'ENDDATA'; is it cut short?")


def _bulk(path: Path, text: str) -> Iterator[tuple[int, str]]:
    """The lines of the bulk data with their numbers, without comments and blank lines."""
    lines = [line.partition("$")[0].rstrip() for line in text.split("\n")]
    begin = [k for k, line in enumerate(lines) if BULK.match(line.strip())]
    if len(begin) > 1:
        raise FormatError(f"{path}, line {begin[1] + 1}: there is a second BEGIN BULK; superelements are not read")
    for k, line in enumerate(lines):
        if INCLUDE.match(line):
            raise FormatError(
                f"{path}, line {k + 1}: found {shown(line.strip().encode())}; the file includes another; "
                "only files that stand alone are read"
            )
    if begin and BULK.match(lines[begin[0]].strip())[1].strip():  # type: ignore[index]
        raise FormatError(f"{path}, line {begin[0] + 1}: {shown(lines[begin[0]].encode())} is not read")
    for k in range(begin[0] + 1 if begin else 0, len(lines)):
        if lines[k]:
            yield k + 1, lines[k]


def _fields(line: str) -> tuple[str, list[str]]:
    """The name of a line, and its fields without blanks."""
    if "," in line:
        name, *fields = [word.strip() for word in line.split(",")]
        return name, fields[:8] if not name.endswith("*") and name[:1] != "*" else fields[:4]
    line = line.expandtabs(8)
    name = line[:8].strip()
    columns = LONG if name.endswith("*") or name[:1] == "*" else SHORT
    return name, [line[a:b].strip() for a, b in columns if a < len(line)]


def _continue(card: Card, fields: list[str]) -> None:
    """Append the fields of a line; a card goes on after whole lines, of eight short fields or of four long ones."""
    step = 4 if len(card.fields) <= 4 and len(fields) <= 4 and card.fields else 8
    card.fields += [""] * (-len(card.fields) % step)
    card.fields += fields
