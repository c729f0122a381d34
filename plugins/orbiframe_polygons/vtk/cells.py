"""Cells of VTK: polygons, strips and the other kinds, made into faces.

Source: VTK File Formats; vtkCellType.h.
"""

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
from orbiframe_polygons.faces import offsets_of, ragged
from orbiframe_polygons.parts import Part
from orbiframe_polygons.strips import RESTART, triangles_of_strips

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

TRIANGLE, POLYGON, PIXEL, QUAD = 5, 7, 8, 9
FACES = {TRIANGLE: 3, POLYGON: 0, PIXEL: 4, QUAD: 4}
BELOW = {
    0: "empty cells",
    1: "vertices",
    2: "vertices",
    3: "lines",
    4: "lines",
    21: "lines",
    35: "lines",
    68: "lines",
    75: "lines",
}
SOLIDS = {10: "tetrahedra", 11: "voxels", 12: "hexahedra", 13: "wedges", 14: "pyramids", 15: "prisms", 16: "prisms",
          24: "tetrahedra", 25: "hexahedra", 26: "wedges", 27: "pyramids", 29: "hexahedra", 32: "wedges",
          33: "hexahedra", 37: "pyramids", 41: "solids", 42: "polyhedra", 71: "tetrahedra", 72: "hexahedra",
          73: "wedges", 74: "pyramids", 78: "tetrahedra", 79: "hexahedra", 80: "wedges", 81: "pyramids"}  # fmt: skip


@dataclass(slots=True)
class Cells:
    """The points of a piece and its faces; what else it has is counted in `passed`."""

    path: Path
    points: Floats
    _sizes: list[Ints] = field(default_factory=list)
    _tails: list[Ints] = field(default_factory=list)
    passed: Counter[str] = field(default_factory=Counter)

    def add_polygons(self, offsets: Ints, connectivity: Ints) -> None:
        """Add polygons; offsets: where each begins, and where the last one ends."""
        sizes = self._sizes_of(offsets, connectivity)
        self._sizes.append(sizes)
        self._tails.append(connectivity)

    def add_strips(self, offsets: Ints, connectivity: Ints) -> None:
        """Add strips of triangles."""
        self._sizes_of(offsets, connectivity)
        made = triangles_of_strips(np.insert(connectivity, offsets[:-1], RESTART))
        self._sizes.append(np.full(len(made), 3, dtype=np.intp))
        self._tails.append(made.ravel())

    def pass_over(self, kind: str, count: int) -> None:
        """Count cells that are no faces."""
        self.passed[kind] += count

    def add_cells(self, types: Ints, offsets: Ints, connectivity: Ints) -> None:
        """Add cells of all kinds, in order."""
        sizes = self._sizes_of(offsets, connectivity)
        if len(types) != len(sizes):
            self._refuse(f"there are {len(sizes)} cells, but {len(types)} types of cells")
        for kind in np.unique(types).tolist():
            count = int((types == kind).sum())
            if kind in BELOW or kind in SOLIDS:
                self.passed[BELOW.get(kind) or SOLIDS[kind]] += count
            elif kind not in FACES:
                self._refuse(f"found cells of the type {kind}, which are not read; triangles, quads and polygons are")
            elif FACES[kind] and (sizes[types == kind] != FACES[kind]).any():
                self._refuse(f"found a cell of the type {kind} that has not {FACES[kind]} corners")
        chosen = np.flatnonzero(np.isin(types, list(FACES)))
        tail = connectivity[ragged(offsets[:-1][chosen], sizes[chosen])]
        pixel = types[chosen] == PIXEL
        last = offsets_of(sizes[chosen])[1:][pixel] - 1
        tail[last - 1], tail[last] = tail[last], tail[last - 1]
        self._sizes.append(sizes[chosen])
        self._tails.append(tail)

    def part(self) -> Part:
        """The faces. Raises FormatError for corners that are no points, and faces of fewer than three."""
        sizes = np.concatenate([np.empty(0, dtype=np.intp), *self._sizes])
        tail = np.concatenate([np.empty(0, dtype=np.intp), *self._tails])
        if tail.min(initial=0) < 0 or tail.max(initial=-1) >= len(self.points):
            bad = tail[((tail < 0) | (tail >= len(self.points))).argmax()]
            self._refuse(f"a face names vertex {bad}, but the vertices are 0 to {len(self.points) - 1}")
        if (sizes < 3).any():
            self._refuse(
                f"face {int((sizes < 3).argmax())} has {sizes[sizes < 3][0]} corners, but 3 are required at least"
            )
        return Part(self.points, sizes, tail)

    def _sizes_of(self, offsets: Ints, connectivity: Ints) -> Ints:
        sizes = np.diff(offsets)
        if len(offsets) < 1 or offsets[0] != 0 or (sizes < 0).any() or offsets[-1] != len(connectivity):
            self._refuse(f"the offsets of the cells do not fit their {len(connectivity)} corners")
        return sizes

    def _refuse(self, complaint: str) -> NoReturn:
        raise FormatError(f"{self.path}: {complaint}")


def tell_passed(path: Path, pieces: Sequence[Cells]) -> None:
    """Warn of the cells that were passed over."""
    passed: Counter[str] = Counter()
    for piece in pieces:
        passed += piece.passed
    if passed:
        said = ", ".join(f"{count} {kind}" for kind, count in sorted(passed.items()))
        warnings.warn(f"{path.name}: besides the faces there are {said}; left out", stacklevel=3)


def parts_of(path: Path, pieces: Sequence[Cells]) -> list[Part]:
    """The pieces that have faces. Raises FormatError where none has."""
    parts = [part for part in (piece.part() for piece in pieces) if len(part.sizes)]
    if not parts:
        passed = {kind for piece in pieces for kind in piece.passed}
        more = f", but only {', '.join(sorted(passed))}" if passed else ""
        raise FormatError(f"{path}: the file holds no triangles, quads or polygons{more}; is it a surface?")
    tell_passed(path, pieces)
    return parts
