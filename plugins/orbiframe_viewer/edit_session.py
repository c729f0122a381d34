"""Edit session: what the page of the editor asks for and sends; the truth lies here, so that any browser shows it."""

from __future__ import annotations

import gzip
import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import Config, OrbiframeError, Registry
from orbiframe_viewer.draft import Draft
from orbiframe_viewer.edit_work import EditWork
from orbiframe_viewer.edited_fit import EditedFit
from orbiframe_viewer.server import Answer, Page

Floats = NDArray[np.float64]
_SIZES = (20, 8000)
_LONGEST_STEP = 1e6  # diagonals


class EditSession(EditWork, Page):
    """An edit as a page sees it: requests change the draft and see it at once, by the linear fit."""

    first, words = "edit.html", "orbiframe edit"
    files = ("viewer.css", "panes.js", "edit.js", "three.min.js")

    def __init__(self, name: str, base: Config, registry: Registry, save: Callable[[EditedFit], list[Path]]) -> None:
        EditWork.__init__(self, base, registry, save)
        Page.__init__(self)
        self.name = name

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
