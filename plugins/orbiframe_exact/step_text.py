"""Text of STEP files, shorter: points that are written twice are written once, and small numbers without exponents."""

from __future__ import annotations

import re

_POINT = re.compile(r"^(#\d+) = (CARTESIAN_POINT\(''[^;]*;)\n", re.MULTILINE)
# From 0.1 down to 0.001 this is longer than what it stands for.
_SMALL = re.compile(r"(\d)\.(\d*)E-0([1-3])(?!\d)")
_NAME_OR_TEXT = re.compile(r"'[^']*'|#\d+")


def shorter(text: str) -> str:
    """The same exchange structure (ISO 10303-21) with every point once, and no blanks where none are needed.

    Control points of faces on a common edge are the same points. Coordinates such as 1.5E-02 are written as 0.015, the
    same decimal number. Text in quotes stays as it is.
    """
    first: dict[str, str] = {}
    other = {}
    for name, point in _POINT.findall(text):
        kept = first.setdefault(re.sub(r"\s", "", point), name)
        if kept != name:
            other[name] = kept
    kept_lines = _POINT.sub(lambda found: "" if found[1] in other else _plain(found[0]), text)
    renamed = _NAME_OR_TEXT.sub(lambda found: other.get(found[0], found[0]), kept_lines)
    return re.sub(r"\n +", "\n", re.sub(r"^(#\d+) = ", r"\1=", renamed, flags=re.MULTILINE))


def _plain(point: str) -> str:
    """A point whose small coordinates have no exponent."""
    return _SMALL.sub(lambda found: "0." + "0" * (int(found[3]) - 1) + found[1] + found[2], point)
