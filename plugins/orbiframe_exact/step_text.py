"""Text of STEP files, shorter: points that are written twice are written once."""

from __future__ import annotations

import re

_POINT = re.compile(r"^(#\d+) = (CARTESIAN_POINT\(''[^;]*;)\n", re.MULTILINE)
_NAME_OR_TEXT = re.compile(r"'[^']*'|#\d+")


def shorter(text: str) -> str:
    """The same exchange structure (ISO 10303-21) with every point once, and no blanks about the signs of equality.

    Control points of faces on a common edge are the same points. Text in quotes stays as it is.
    """
    first: dict[str, str] = {}
    other = {}
    for name, point in _POINT.findall(text):
        kept = first.setdefault(re.sub(r"\s", "", point), name)
        if kept != name:
            other[name] = kept
    kept_lines = _POINT.sub(lambda found: "" if found[1] in other else found[0], text)
    renamed = _NAME_OR_TEXT.sub(lambda found: other.get(found[0], found[0]), kept_lines)
    return re.sub(r"^(#\d+) = ", r"\1=", renamed, flags=re.MULTILINE)
