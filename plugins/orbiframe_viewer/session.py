"""Session: what the page of the viewer asks for."""

from __future__ import annotations

import gzip
import json
import threading
from collections.abc import Sequence
from typing import Any

from orbiframe_viewer.scene import Scene
from orbiframe_viewer.server import Answer, Page


class Session(Page):
    """The stages of the work, and at its end the scenes or the error."""

    first, words = "index.html", "orbiframe view"
    files = ("viewer.css", "panes.js", "viewer.js", "three.min.js")

    def __init__(self, name: str) -> None:
        super().__init__()
        self.told = threading.Event()  # whether a page has heard of the end
        self._lock = threading.Lock()
        self._state: dict[str, Any] = {"name": name, "stages": [], "ready": False, "error": None}
        self._scenes = b""

    def asked(self, name: str, _query: dict[str, str]) -> Answer | None:
        """The state, and the scenes once they are there."""
        if name == "state.json":
            return Answer(self.state, "json")
        if name == "scenes.json" and self.scenes:
            return Answer(self.scenes, "json", packed=True)
        return None

    def stage(self, name: str, seconds: float | None) -> None:
        """Hear of a stage, as progress is told."""
        with self._lock:
            stages = self._state["stages"]
            if seconds is None:
                stages.append([name, None])
            elif stages and stages[-1][0] == name:
                stages[-1][1] = round(seconds, 2)

    def finish(self, scenes: Sequence[Scene]) -> None:
        """The scenes are there."""
        content = gzip.compress(json.dumps(list(scenes)).encode(), 1)
        with self._lock:
            self._scenes, self._state["ready"] = content, True

    def fail(self, error: str) -> None:
        """There will be none."""
        with self._lock:
            self._state["error"] = error

    @property
    def state(self) -> bytes:
        """The state as JSON."""
        with self._lock:
            if self._state["error"]:
                self.told.set()
            return json.dumps(self._state).encode()

    @property
    def scenes(self) -> bytes:
        """The scenes as JSON, compressed; empty before they are there."""
        with self._lock:
            return self._scenes
