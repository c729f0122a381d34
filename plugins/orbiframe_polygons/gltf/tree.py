"""Tree: the JSON of a glTF, parsed once and strictly, and typed looks into it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError
from orbiframe_polygons.text import MARK, shown

LARGEST = 2**40


@dataclass(frozen=True, slots=True)
class Node:
    """An object of the JSON with its place, such as accessors[3]."""

    path: Path
    place: str
    content: Mapping[str, Any]

    def has(self, key: str) -> bool:
        """Whether the key is there."""
        return key in self.content

    def index(self, key: str, default: int | None = None, *, most: int = LARGEST) -> int:
        """A whole number from 0 to `most`. Raises FormatError where it is none, or missing without a default."""
        value = self.content.get(key, default)
        if type(value) is not int or not 0 <= value <= most:
            self.refuse(f"'{key}' is {_brief(value)}, but a whole number from 0 to {most} is required")
        return value

    def flag(self, key: str) -> bool:
        """True or false; false where it is missing."""
        value = self.content.get(key, False)
        if type(value) is not bool:
            self.refuse(f"'{key}' is {_brief(value)}, but true or false is required")
        return value

    def word(self, key: str) -> str:
        """A string. Raises FormatError where it is none or missing."""
        value = self.content.get(key)
        if not isinstance(value, str):
            self.refuse(f"'{key}' is {_brief(value)}, but a string is required")
        return value

    def words(self, key: str) -> list[str]:
        """A list of strings, empty where it is missing."""
        values = self.content.get(key, [])
        if not isinstance(values, list) or not all(isinstance(value, str) for value in values):
            self.refuse(f"'{key}' is {_brief(values)}, but a list of strings is required")
        return values

    def indices(self, key: str, most: int) -> list[int]:
        """A list of whole numbers below `most`, empty where it is missing."""
        values = self.content.get(key, [])
        if not isinstance(values, list) or not all(type(v) is int and 0 <= v < most for v in values):
            self.refuse(f"'{key}' is {_brief(values)}, but a list of whole numbers below {most} is required")
        return values

    def numbers(self, key: str, default: list[float], *, count: int | None) -> NDArray[np.float64]:
        """A list of finite numbers, of a given count unless that is None."""
        values = self.content.get(key, default)
        fits = isinstance(values, list) and all(type(v) in (int, float) and abs(v) < 1e300 for v in values)
        if not fits or (count is not None and len(values) != count):
            self.refuse(f"'{key}' is {_brief(values)}, but {count or 'a list of'} finite numbers are required")
        return np.array(values, dtype=np.float64)

    def child(self, key: str) -> Node:
        """An object; an empty one where it is missing."""
        value = self.content.get(key, {})
        if not isinstance(value, dict):
            self.refuse(f"'{key}' is {_brief(value)}, but an object is required")
        return Node(self.path, f"{self.place}.{key}".lstrip("."), value)

    def children(self, key: str) -> list[Node]:
        """A list of objects, empty where it is missing."""
        values = self.content.get(key, [])
        if not isinstance(values, list) or not all(isinstance(value, dict) for value in values):
            self.refuse(f"'{key}' is {_brief(values)}, but a list of objects is required")
        place = f"{self.place}.{key}".lstrip(".")
        return [Node(self.path, f"{place}[{k}]", value) for k, value in enumerate(values)]

    def refuse(self, complaint: str) -> NoReturn:
        """Raise FormatError with the file and the place."""
        raise FormatError(f"{self.path}: {self.place or 'the glTF'}: {complaint}")


def parsed(path: Path, text: bytes) -> Node:
    """The root of a JSON text in UTF-8. Raises FormatError for a key that stands twice, and for what is no object."""
    try:
        tree = json.loads(
            text.removeprefix(MARK).decode("utf-8"), object_pairs_hook=_unique, parse_constant=_no_constant
        )
    except (ValueError, RecursionError) as error:
        reason = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise FormatError(f"{path}: this is no glTF: {reason[:200]}") from error
    if not isinstance(tree, dict):
        raise FormatError(f"{path}: this is no glTF: an object is required, but there is {_brief(tree)}")
    return Node(path, "", tree)


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise ValueError(f"the key {shown(key.encode('utf-8', errors='replace'))} stands twice in one object")
        found[key] = value
    return found


def _no_constant(word: str) -> NoReturn:
    raise ValueError(f"found {word}, which is no number in JSON")


def _brief(value: object) -> str:
    if value is None:
        return "missing"
    if isinstance(value, dict):
        return "an object"
    return shown(f"{value!r:.60}".encode("utf-8", errors="replace"))
