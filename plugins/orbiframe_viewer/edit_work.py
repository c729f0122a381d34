"""Edit work: drafts are fitted one after the other in a thread of their own; the next one ends the fit before."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from orbiframe import Config, OrbiframeError, Polyhedron, Registry
from orbiframe_viewer.draft import Draft, History
from orbiframe_viewer.edited_fit import EditedFit, edited_fit


class Superseded(Exception):
    """The draft that is being fitted is not the one that is wanted any more."""


class EditWork:
    """A mesh with the history of its drafts, the last fit, and the work that fits what is wanted.

    Everything is read and changed while `_changed` is held. save: writes a fit, and says in which files.
    """

    def __init__(self, base: Config, registry: Registry, save: Callable[[EditedFit], list[Path]]) -> None:
        self.base, self.registry, self._save = base, registry, save
        self.fit: EditedFit | None = None
        self.history: History | None = None
        self.ended = False
        self._changed = threading.Condition()
        self._picture = self._shape = self._fits = 0  # counters, by which a page knows what is new
        self._stages: list[list[Any]] = []
        self._working, self._saving = True, False
        self._said, self._error = "", ""
        self._middle, self._scale = np.zeros(3), 1.0
        self._failed: Draft | None = None
        self._wanted: Draft | None = None

    def begin(self, mesh: Polyhedron, draft: Draft, first: EditedFit) -> None:
        """The first fit is there, of a mesh that is edited from now on."""
        with self._changed:
            self.mesh, self.fit, self.history = mesh, first, History([draft])
            low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
            self._middle, self._scale = (low + high) / 2, float(np.linalg.norm(high - low))
            self._working, self._picture, self._shape = False, 1, 1
            self._said = _told(first, None)

    def stage(self, name: str, seconds: float | None) -> None:
        """Hear of a stage; raises Superseded where its fit is wanted no more."""
        with self._changed:
            if seconds is None:
                self._stages.append([name, None])
            elif self._stages and self._stages[-1][0] == name:
                self._stages[-1][1] = round(seconds, 2)
            if self.ended or (self.history is not None and self._wanted is not self.history.now):
                raise Superseded

    def fail(self, error: str) -> None:
        """There will be no surface."""
        with self._changed:
            self._error, self._working = error, False

    def work(self) -> None:
        """Fit every draft that is wanted, until the session ends; to be run in a thread."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self.ended or self._to_do)
                if self.ended:
                    return
                assert self.history is not None
                assert self.fit is not None
                draft, before = self.history.now, self.fit
                saving = self._saving and self._is_fitted(draft)
            if saving:
                self._write(draft)
            else:
                self._refit(draft, before)

    @property
    def _to_do(self) -> bool:
        assert self.history is not None
        fitted = self._is_fitted(self.history.now)
        return self._saving or (not fitted and self._failed is not self.history.now)

    def _is_fitted(self, draft: Draft) -> bool:
        return self.fit is not None and draft.same_fit(self.fit.draft)

    def _refit(self, draft: Draft, before: EditedFit) -> None:
        start = time.perf_counter()
        with self._changed:
            self._wanted, self._working, self._stages, self._error = draft, True, [], ""
        try:
            found = edited_fit(self.mesh, draft, self.base, self.registry, self.stage, before)
        except Superseded:
            with self._changed:
                self._working = False
            return
        except Exception as error:
            with self._changed:
                self._failed, self._working, self._saving = draft, False, False
                self._error = f"{_sentence(error)}; the picture is that of the linear fit before"
            return
        with self._changed:
            assert self.history is not None
            if self.history.now is draft:
                self.history.correct(found.draft)
            self.fit, self._fits = found, self._fits + 1
            self._shape += found.display is not before.display or not np.array_equal(found.controls, before.controls)
            self._picture += 1
            self._working = False
            self._said = _told(found, time.perf_counter() - start)

    def _write(self, draft: Draft) -> None:
        assert self.fit is not None
        assert self.history is not None
        try:
            files = self._save(replace(self.fit, draft=draft))
            said, error = f"saved: {', '.join(file.name for file in files)}", ""
        except (OrbiframeError, OSError) as problem:
            said, error = "", f"nothing is saved: {problem}"
        with self._changed:
            self._saving, self._said, self._error = False, said or self._said, error
            if not error:
                self.history.saved = draft

    def end(self) -> None:
        """The session ends; nothing more is fitted."""
        with self._changed:
            self.ended = True
            self._changed.notify_all()


def _told(found: EditedFit, seconds: float | None) -> str:
    """A fit in a sentence."""
    part = found.result.report["fit"]
    after = "" if seconds is None else f" in {seconds:.1f} s"
    first = (
        f"fitted{after} by {part['fitter']}: {part['size']} functions of {part['basis']}, rms {part['rms']:.1e}, "
        f"largest {part['max']:.1e} of the diagonal"
    )
    return "\n".join((first, *found.notes))


def _sentence(error: Exception) -> str:
    if isinstance(error, OrbiframeError | OSError):
        return str(error)
    return f"internal error, {type(error).__name__}: {error}"
