"""Draft: what a user has made of a mesh so far, and the steps that led there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import Config
from orbiframe.fitting import tables_of

Floats = NDArray[np.float64]
Moved = tuple[tuple[int, float, float, float], ...]


@dataclass(frozen=True, eq=False)
class Draft:
    """The vertices (V, 3) of the mesh, coefficients moved by hand, and the tables of functions and fitter.

    numbered: the draft by whose fit the functions of moved coefficients are numbered; None for the draft itself.
    """

    vertices: Floats
    moved: Moved
    basis: Mapping[str, Any]
    fitter: Mapping[str, Any]
    numbered: Draft | None = None

    def with_vertex(self, vertex: int, way: Floats) -> Draft:
        """With one vertex moved."""
        vertices = self.vertices.copy()
        vertices[vertex] += way
        return replace(self, vertices=vertices)

    def with_coefficient(self, number: int, way: Floats) -> Draft:
        """With one coefficient moved; its function is one of the fit of this draft."""
        found = {k: np.array(each) for k, *each in self.moved}
        found[number] = found.get(number, np.zeros(3)) + way
        moved = tuple((k, *(float(x) for x in each)) for k, each in sorted(found.items()))
        return replace(self, moved=moved, numbered=self)  # type: ignore[arg-type]

    def numbered_by(self, fitted: Draft) -> bool:
        """Whether moved coefficients are those of the fit of another draft."""
        return not self.moved or (self.numbered or self).same_fit(fitted)

    def offsets(self, size: int) -> Floats:
        """By how much the coefficients are moved, (size, 3)."""
        found = np.zeros((size, 3))
        for number, *way in self.moved:
            found[number] = way
        return found

    def same_fit(self, other: Draft) -> bool:
        """Whether the fit is the same: coefficients are moved after it."""
        alike = dict(self.basis) == dict(other.basis) and dict(self.fitter) == dict(other.fitter)
        return alike and np.array_equal(self.vertices, other.vertices)

    def config(self, base: Config, means: str | None) -> Config:
        """The configuration of the fit: that of the command, with the functions and the fitter of the draft."""
        tables: dict[str, Any] = tables_of(base) | {"basis": dict(self.basis), "fitter": dict(self.fitter)}
        output = {
            key: value for key, value in tables["output"].items() if key not in ("tolerance", "max_error", "moved")
        }
        data = tables["data"] | ({} if means is None else {"means": means})
        found = Config.from_tables(tables | {"output": output, "data": data})
        return replace(found, plugins=base.plugins)


@dataclass
class History:
    """Drafts one after the other, the one that is shown, and the one that is saved."""

    drafts: list[Draft]
    place: int = 0
    saved: Draft | None = field(default=None)

    def __post_init__(self) -> None:
        self.saved = self.now

    @property
    def now(self) -> Draft:
        """The draft that is shown."""
        return self.drafts[self.place]

    @property
    def unsaved(self) -> bool:
        """Whether there is something that is not saved."""
        return self.now is not self.saved

    @property
    def undoable(self) -> int:
        """How many steps can be taken back."""
        return self.place

    @property
    def redoable(self) -> int:
        """How many steps that were taken back can be made again."""
        return len(self.drafts) - 1 - self.place

    def add(self, draft: Draft) -> None:
        """Make a step; those that were taken back are forgotten."""
        self.drafts[self.place + 1 :] = [draft]
        self.place += 1

    def correct(self, draft: Draft) -> None:
        """Put another draft in the place of the one that is shown, as the same step."""
        if self.saved is self.now:
            self.saved = draft
        self.drafts[self.place] = draft

    def step(self, by: int) -> bool:
        """Go back (-1) or on (1); False where there is nothing."""
        if not 0 <= self.place + by < len(self.drafts):
            return False
        self.place += by
        return True
