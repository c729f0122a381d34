"""Edit session: what the page of the editor asks for and sends; the truth lies here, so that any browser shows it."""

from __future__ import annotations

import gzip
import json
import math
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import Config, OrbiframeError, Polyhedron, Registry
from orbiframe_viewer.draft import Draft, History
from orbiframe_viewer.edited_fit import EditedFit, edited_fit
from orbiframe_viewer.server import Answer, Page

Floats = NDArray[np.float64]
_SIZES = (20, 8000)
_LONGEST_STEP = 1e6  # diagonals


class Superseded(Exception):
    """The draft that is being fitted is not the one that is wanted any more."""


class EditSession(Page):
    """A mesh with the history of its drafts, and the last fit.

    Requests change the draft and see it at once, by the linear fit; `work` fits it, in a thread of its own, and is
    begun again by the next change. save: writes a fit, and says in words where.
    """

    first, words = "edit.html", "orbiframe edit"
    files = ("viewer.css", "panes.js", "edit.js", "three.min.js")

    def __init__(self, name: str, base: Config, registry: Registry, save: Callable[[EditedFit], list[Path]]) -> None:
        super().__init__()
        self.name, self.base, self.registry, self._save = name, base, registry, save
        self.fit: EditedFit | None = None
        self.history: History | None = None
        self.ended = False
        self._changed = threading.Condition()
        self._picture = self._shape = self._fits = 0
        self._stages: list[list[Any]] = []
        self._working, self._saving = True, False
        self._said, self._error = "", ""
        self._middle, self._scale = np.zeros(3), 1.0
        self._failed: Draft | None = None
        self._wanted: Draft | None = None

    # ---- the beginning ----

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

    # ---- the work ----

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

    # ---- what a page asks for ----

    def asked(self, name: str, query: dict[str, str]) -> Answer | None:
        """The state, what stays while the map stays, the numbers of the picture, and the influence of a handle."""
        if name == "state.json":
            return Answer(json.dumps(self.state).encode(), "json")
        if self.fit is None or self.history is None:
            return None
        if name == "scene.json":
            return Answer(gzip.compress(json.dumps(self._scene()).encode(), 1), "json", packed=True)
        if name == "picture.bin":
            return Answer(self._numbers(), "bin")
        if name == "influence.bin":
            return self._influence(query)
        return None

    @property
    def state(self) -> dict[str, Any]:
        """What is going on, as plain data."""
        with self._changed:
            found: dict[str, Any] = {
                "name": self.name,
                "ready": self.fit is not None,
                "working": self._working,
                "saving": self._saving,
                "stages": [list(each) for each in self._stages],
                "error": self._error,
                "said": self._said,
                "picture": self._picture,
                "shape": self._shape,
                "fits": self._fits,
            }
            if self.history is not None and self.fit is not None:
                draft = self.history.now
                found |= {
                    "moved": len(draft.moved),
                    "undo": self.history.undoable,
                    "redo": self.history.redoable,
                    "unsaved": self.history.unsaved,
                    "fitted": self._is_fitted(draft),
                    "basis": draft.basis["name"],
                    "size": draft.basis.get("size"),
                    "fitter": draft.fitter["name"],
                    "fairing": draft.fitter.get("fairing"),
                    "bases": [each.name for each in self.registry.components("basis")],
                    "fitters": [each.name for each in self.registry.components("fitter")],
                    "sizes": list(_SIZES),
                }
            return found

    def _scene(self) -> dict[str, Any]:
        with self._changed:
            assert self.fit is not None
            fit, shape = self.fit, self._shape
        return fit.display.scene(self.mesh, self.name, self._middle, self._scale, fit.controls, shape)

    def _numbers(self) -> bytes:
        """Vertices (V, 3), then points and derivatives, as float32, about the middle, in diagonals."""
        with self._changed:
            assert self.fit is not None
            assert self.history is not None
            fit, draft = self.fit, self.history.now
        shown = fit.shown(draft) / self._scale
        shown[0] -= self._middle / self._scale
        vertices = (draft.vertices - self._middle) / self._scale
        return b"".join(np.ascontiguousarray(part, dtype=np.float32).tobytes() for part in (vertices, shown))

    def _influence(self, query: dict[str, str]) -> Answer | None:
        """How points and derivatives move with a vertex or a function, as float32."""
        with self._changed:
            fit = self.fit
        assert fit is not None
        size, count = len(fit.controls), len(self.mesh.vertices)
        for key, most in (("vertex", count), ("control", size)):
            if query.get(key, "").isdecimal() and int(query[key]) < most:
                number = int(query[key])
                column = fit.influence.of_vertex(number) if key == "vertex" else _unit(size, number, fit.peaks[number])
                shown = fit.influence.shown(column[:, None])
                return Answer(np.ascontiguousarray(shown, dtype=np.float32).tobytes(), "bin")
        return None

    # ---- what a page sends ----

    def sent(self, name: str, body: Any) -> Answer | None:
        """A step, or a wish to save; the answer is the state, or what is wrong."""
        acts = {"move": self._move, "set": self._set, "undo": self._undo, "redo": self._redo, "save": self._wish}
        if name not in acts or self.history is None or not isinstance(body, dict):
            return None
        with self._changed:
            try:
                acts[name](body)
            except (KeyError, TypeError, ValueError, OrbiframeError) as error:
                words = str(error) if isinstance(error, OrbiframeError) else f"this cannot be done: {error}"
                return Answer(json.dumps({"error": words}).encode(), "json", status=400)
            self._changed.notify_all()
        return Answer(json.dumps(self.state).encode(), "json")

    def _move(self, body: dict[str, Any]) -> None:
        assert self.history is not None
        assert self.fit is not None
        way = np.array([float(x) for x in body["by"]])
        if way.shape != (3,) or not np.abs(way).max() < _LONGEST_STEP * self._scale:
            raise ValueError(f"a way is three numbers, not {body['by']}")
        draft = self.history.now
        if "vertex" in body:
            self._add(draft.with_vertex(_index(body["vertex"], len(draft.vertices)), way))
        else:
            number = _index(body["control"], len(self.fit.controls))
            if not self._is_fitted(draft):
                raise ValueError("the functions are being made anew; wait for the fit")
            self._add(draft.with_coefficient(number, way / self.fit.peaks[number]))

    def _set(self, body: dict[str, Any]) -> None:
        assert self.history is not None
        draft = self.history.now
        basis, fitter = dict(draft.basis), dict(draft.fitter)
        if "basis" in body and body["basis"] != basis["name"]:
            basis = {"name": str(body["basis"]), **({"size": basis["size"]} if "size" in basis else {})}
        if "size" in body:
            basis["size"] = int(np.clip(int(body["size"]), *_SIZES))
        if "fitter" in body and body["fitter"] != fitter["name"]:
            fairing = {"fairing": fitter["fairing"]} if "fairing" in fitter else {}
            fitter = {"name": str(body["fitter"]), **fairing}
        if "fairing" in body:
            fitter.pop("fairing", None)
            if body["fairing"] is not None:
                fitter["fairing"] = _fairing(body["fairing"])
        new = replace(draft, basis=basis, fitter=fitter)
        new.config(self.base, None).checked(self.registry)
        self._add(new)

    def _add(self, draft: Draft) -> None:
        assert self.history is not None
        self.history.add(draft)
        self._picture += 1

    def _undo(self, _: dict[str, Any]) -> None:
        self._step(-1)

    def _redo(self, _: dict[str, Any]) -> None:
        self._step(1)

    def _step(self, by: int) -> None:
        assert self.history is not None
        if self.history.step(by):
            self._error = ""
            self._picture += 1

    def _wish(self, _: dict[str, Any]) -> None:
        self._saving, self._failed = True, None

    def end(self) -> None:
        """The session ends; nothing more is fitted."""
        with self._changed:
            self.ended = True
            self._changed.notify_all()


def _unit(size: int, number: int, peak: float) -> Floats:
    found = np.zeros(size)
    found[number] = 1 / peak
    return found


def _index(value: Any, count: int) -> int:
    number = int(value)
    if not 0 <= number < count:
        raise ValueError(f"{number} is none of 0 to {count - 1}")
    return number


def _fairing(value: Any) -> float:
    number = float(value)
    if not 0 <= number < math.inf:
        raise ValueError(f"fairing is a number from 0 on, not {value}")
    return number


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
    with suppress(Exception):
        if isinstance(error, OrbiframeError | OSError):
            return str(error)
    return f"internal error, {type(error).__name__}: {error}"
