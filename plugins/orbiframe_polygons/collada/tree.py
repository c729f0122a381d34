"""Tree: the elements of a COLLADA file, and looks into them that name the line."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError
from orbiframe_polygons.faces import whole
from orbiframe_polygons.text import named, table
from orbiframe_polygons.xml_events import parse

DEPTH = 200


@dataclass(slots=True)
class Element:
    """An element with its attributes, its text and what stands inside it."""

    path: Path
    name: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)
    pieces: list[str] = field(default_factory=list)

    def all(self, *names: str) -> list[Element]:
        """The elements inside that have one of these names."""
        return [child for child in self.children if child.name in names]

    def first(self, name: str) -> Element | None:
        """The first element inside with this name; None where there is none."""
        return next(iter(self.all(name)), None)

    def only(self, name: str) -> Element:
        """The one element inside with this name. Raises FormatError where there is none, or several."""
        found = self.all(name)
        if len(found) != 1:
            self.refuse(f"there are {len(found)} elements '{name}', but one is required")
        return found[0]

    def everywhere(self, name: str) -> Iterator[Element]:
        """All elements with this name, at any depth."""
        for child in self.children:
            if child.name == name:
                yield child
            yield from child.everywhere(name)

    def attribute(self, name: str) -> str:
        """An attribute. Raises FormatError where it is missing."""
        if name not in self.attributes:
            self.refuse(f"the attribute '{name}' is missing")
        return self.attributes[name]

    def count(self, name: str, default: int | None = None) -> int:
        """An attribute that is a count."""
        if default is not None and name not in self.attributes:
            return default
        word = self.attribute(name)
        if not (word.isascii() and word.isdigit() and len(word) < 16):
            self.refuse(f"{name} is {word[:20]!r}, but a whole number is required")
        return int(word)

    def reference(self, name: str) -> str:
        """The identifier that an attribute points to. Raises FormatError for one in another file."""
        word = self.attribute(name)
        if not word.startswith("#"):
            self.refuse(f"{name}={word[:60]!r} points to another file, which is not opened")
        return word[1:]

    def numbers(self) -> NDArray[np.float64]:
        """The text as finite numbers."""
        return table(self.path, "".join(self.pieces).encode(), line=self.line).numbers()

    def whole(self) -> NDArray[np.intp]:
        """The text as whole numbers."""
        return whole(self.numbers(), lambda _: f"{self.path}, line {self.line}")

    def refuse(self, complaint: str) -> NoReturn:
        """Raise FormatError with the line and the name."""
        raise FormatError(f"{self.path}, line {self.line}: {named(self.name)}: {complaint}")


def tree(path: Path) -> Element:
    """The elements of a file. Raises FormatError for what is no COLLADA, and for elements nested too deeply."""
    outside = Element(path, "", {}, 1)
    above = [outside]

    def start(name: str, attributes: dict[str, str], line: int) -> None:
        element = Element(path, name, attributes, line)
        if len(above) > DEPTH:
            element.refuse(f"elements are nested more than {DEPTH} deep")
        above[-1].children.append(element)
        above.append(element)

    def end(_: str) -> None:
        above.pop()

    parse(path, path.read_bytes(), start, lambda text: above[-1].pieces.append(text), end)
    return outside.only("COLLADA")


def by_id(root: Element, name: str) -> dict[str, Element]:
    """The elements of a name by their identifiers. Raises FormatError where one stands twice."""
    found: dict[str, Element] = {}
    for element in root.everywhere(name):
        key = element.attributes.get("id")
        if key in found:
            element.refuse(f"the identifier {key[:40]!r} stands twice")
        if key is not None:
            found[key] = element
    return found
