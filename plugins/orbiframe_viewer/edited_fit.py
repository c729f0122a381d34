"""Edited fit: the surface of a draft, with the linear maps by which its picture follows while a vertex is dragged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import Config, MapError, OrbifoldSurface, Polyhedron, Registry, fit
from orbiframe.fitting import Result
from orbiframe.functions import PreparedFitter
from orbiframe_viewer.draft import Draft, Moved
from orbiframe_viewer.edit_scene import Display
from orbiframe_viewer.influence import Influence

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Progress = Callable[[str, float | None], None]

# Functions that are less alike than this were exchanged for others.
_ALIKE = 0.98


@dataclass(frozen=True, eq=False)
class EditedFit:
    """A draft, its fit, what is shown of it, and what a user should know.

    controls, peaks: for each function the point where it is largest, and how large it is there.
    """

    draft: Draft
    result: Result
    display: Display
    influence: Influence
    controls: Ints
    peaks: Floats
    notes: tuple[str, ...]

    @property
    def owns_map(self) -> bool:
        """Whether the map was made for this draft, and not taken over."""
        return self.result.report["map"]["like"] is None

    @property
    def surface(self) -> OrbifoldSurface:
        """The surface with the coefficients that are moved by hand."""
        fitted = self.result.surface
        offsets = self.draft.offsets(fitted.basis.size) / fitted.scale
        return replace(fitted, coefficients=fitted.coefficients + offsets)

    def shown(self, draft: Draft) -> Floats:
        """Points and derivatives (1 or 3, n, 3) in space of a draft with the same functions, by the linear fit."""
        fitted = self.result.surface
        moved = draft if draft.numbered_by(self.draft) else self.draft
        coefficients = fitted.coefficients + moved.offsets(fitted.basis.size) / fitted.scale
        moves = draft.vertices - self.draft.vertices
        if moves.any():
            coefficients = coefficients + self.influence.of_vertices(moves) / fitted.scale
        found = fitted.scale * self.influence.shown(coefficients)
        found[0] += fitted.origin
        return found


def edited_fit(
    mesh: Polyhedron, draft: Draft, base: Config, registry: Registry, progress: Progress, before: EditedFit
) -> EditedFit:
    """The fit of a draft; the map, the points that are shown and what the mesh means are those before, where it serves.

    Raises what `fit` raises.
    """
    moved, config = mesh.with_vertices(draft.vertices), draft.config(base, before.result.report["data"]["means"])
    notes: tuple[str, ...] = ()
    try:
        result = fit(moved, config, registry, progress, like=before.result.surface)
    except MapError as error:
        notes = (f"a new map was made: {error}",)
        result = fit(moved, replace(config, like=None), registry, progress)
    progress("picture", None)
    same = _same_map(before.result.surface, result.surface)
    display = before.display if same else Display.of(result.surface, mesh)
    found = shown_fit(draft, result, display, registry, notes)
    if draft.numbered_by(draft):
        return found
    draft, said = _again(draft, before, found.influence, same)
    return replace(found, draft=draft, notes=(*found.notes, *said))


def shown_fit(
    draft: Draft, result: Result, display: Display, registry: Registry, notes: tuple[str, ...] = ()
) -> EditedFit:
    """A fit with what its picture needs."""
    influence = Influence(result.surface, result.samples, display.points, display.signs, _linear(registry, draft))
    return EditedFit(
        draft, result, display, influence, *influence.handles(display.count), (*notes, *result.report["notes"])
    )


def _linear(registry: Registry, draft: Draft) -> PreparedFitter:
    """The linear fit whose factor is kept, with the fairing of the draft."""
    fairing = draft.fitter.get("fairing")
    found: PreparedFitter = registry.load("fitter", "least-squares")(fairing=fairing)
    return found


def _same_map(old: OrbifoldSurface, new: OrbifoldSurface) -> bool:
    """Whether the points of X/H that were shown are there again."""
    one, other = old.triangulation, new.triangulation
    return one.points is other.points or (
        np.array_equal(one.points, other.points) and np.array_equal(one.transition, other.transition)
    )


def _again(draft: Draft, before: EditedFit, influence: Influence, same_map: bool) -> tuple[Draft, list[str]]:
    """The draft with its moved coefficients at the functions that are most alike to those before."""
    if not same_map or not draft.numbered_by(before.draft):
        return replace(draft, moved=()), ["control points that were moved by hand are those of the fit again"]
    old, new = before.influence.jets[0], influence.jets[0]
    if old.shape == new.shape and old.nnz == new.nnz and abs(old - new).max() == 0:
        return replace(draft, numbered=None), []
    found: dict[int, Floats] = {}
    least = 1.0
    sizes = np.sqrt(np.asarray(new.multiply(new).sum(axis=0)).ravel())
    for number, *way in draft.moved:
        column = old[:, [number]].toarray()[:, 0]
        alike = np.asarray(new.T @ column) / np.maximum(sizes * np.linalg.norm(column), np.finfo(float).tiny)
        best = int(np.argmax(alike))
        least = min(least, float(alike[best]))
        found[best] = found.get(best, np.zeros(3)) + np.array(way)
    moved: Moved = tuple((k, *(float(x) for x in way)) for k, way in sorted(found.items()))  # type: ignore[misc]
    said = "control points that were moved belong to functions that are others now, near the old ones"
    return replace(draft, moved=moved, numbered=None), [said] if least < _ALIKE else []
