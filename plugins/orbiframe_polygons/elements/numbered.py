"""Numbered: nodes and faces that carry numbers of their own, made into a polyhedron."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError
from orbiframe_polygons.parts import Part

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(slots=True)
class Numbered:
    """Blocks of nodes and of faces in the order of the file.

    passed: how many cells of other kinds were passed over, by their kind; solids: the kinds among them that fill space.
    """

    path: Path
    _numbers: list[Ints] = field(default_factory=list)
    _points: list[Floats] = field(default_factory=list)
    _names: list[Ints] = field(default_factory=list)
    _corners: list[Ints] = field(default_factory=list)
    passed: Counter[str] = field(default_factory=Counter)
    solids: set[str] = field(default_factory=set)

    def add_nodes(self, numbers: Ints, points: Floats) -> None:
        """Add nodes (n,) with coordinates (n, 3)."""
        self._numbers.append(numbers)
        self._points.append(points)

    def add_faces(self, names: Ints, corners: Ints) -> None:
        """Add faces of one size, (n,) numbers and (n, size) corners."""
        if len(corners):
            self._names.append(names)
            self._corners.append(corners)

    def skip(self, kind: str, count: int, *, solid: bool = False) -> None:
        """Count cells that are no faces."""
        self.passed[kind] += count
        if solid and count:
            self.solids.add(kind)

    @property
    def is_empty(self) -> bool:
        """Whether there is no face."""
        return not self._corners

    def part(self) -> Part:
        """The faces with their nodes.

        Raises FormatError where two nodes or two faces have one number, or a corner names no node.
        """
        numbers = _joined(self._numbers)
        points = np.concatenate(self._points) if self._points else np.empty((0, 3))
        order = np.argsort(numbers, kind="stable")
        numbers, points = numbers[order], points[order]
        again = np.flatnonzero((numbers[1:] == numbers[:-1]) & (points[1:] != points[:-1]).any(axis=1))
        if len(again):
            self._refuse(f"the node {numbers[again[0]]} stands twice, at different places")
        names = np.sort(_joined(self._names))
        twice = np.flatnonzero(names[1:] == names[:-1])
        if len(twice):
            self._refuse(f"the element {names[twice[0]]} stands twice")
        tail = _joined([block.ravel() for block in self._corners])
        place = np.minimum(np.searchsorted(numbers, tail), max(0, len(numbers) - 1))
        lost = numbers[place] != tail if len(numbers) else np.ones(len(tail), dtype=np.bool_)
        if lost.any():
            self._refuse(f"a face names the node {tail[int(lost.argmax())]}, which is not there")
        back = np.empty(len(order), dtype=np.intp)
        back[order] = np.arange(len(order))
        original = np.empty_like(points)
        original[order] = points
        sizes = [np.full(len(block), block.shape[1], dtype=np.intp) for block in self._corners]
        return Part(original, _joined(sizes), order[place])

    def _refuse(self, complaint: str) -> NoReturn:
        raise FormatError(f"{self.path}: {complaint}")


def tell_passed(path: Path, blocks: Sequence[Numbered]) -> None:
    """Warn of the cells that were passed over; raise FormatError where there are no faces."""
    passed: Counter[str] = Counter()
    for block in blocks:
        passed += block.passed
    said = ", ".join(f"{count} {kind}" for kind, count in sorted(passed.items()))
    if all(block.is_empty for block in blocks):
        solid = any(block.solids for block in blocks)
        more = f", but only {said}" if said else ""
        advice = "; save the surface of the solid" if solid else ""
        raise FormatError(f"{path}: the file holds no triangles, quads or polygons{more}{advice}")
    if said:
        warnings.warn(f"{path.name}: besides the faces there are {said}; left out", stacklevel=3)


def _joined(blocks: Sequence[Ints]) -> Ints:
    return np.concatenate(blocks) if blocks else np.empty(0, dtype=np.intp)
