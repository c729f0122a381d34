"""Stages: the steps of a fit, run one after the other, told to who listens, and timed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from orbiframe.components.registry import Registry
from orbiframe.fitting.kept_maps import KeptMaps
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.planes.geometry import Geometry
from orbiframe.triangulations.triangulation import Triangulation

Progress = Callable[[str, float | None], None]


@dataclass(frozen=True, eq=False)
class Stages:
    """Runs the steps, tells who listens, and keeps the seconds; maps: where maps are kept, None for nowhere."""

    registry: Registry
    progress: Progress
    seconds: dict[str, float] = field(default_factory=dict)
    maps: KeptMaps | None = None

    def __call__(self, name: str, step: Callable[..., Any], *arguments: Any) -> Any:
        """Run one step and return what it returns."""
        self.progress(name, None)
        start = time.perf_counter()
        result = step(*arguments)
        seconds = time.perf_counter() - start
        self.seconds[name] = self.seconds.get(name, 0.0) + seconds
        self.registry.stage_done(name, result, seconds)
        self.progress(name, seconds)
        return result

    def mapped(
        self, name: str, key: Callable[[], str], mesh: Polyhedron, geometry: Geometry, make: Callable[[], Triangulation]
    ) -> Triangulation:
        """A step that makes a map of a mesh, or takes the one that is kept for this key."""
        if self.maps is None:
            found: Triangulation = self(name, make)
        else:
            found = self(name, self.maps, key(), mesh, geometry, make)
        return found
