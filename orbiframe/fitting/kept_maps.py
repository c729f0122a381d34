"""Kept maps: each map is computed once, and read from a folder by whoever needs it again."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import replace
from pathlib import Path

from orbiframe.errors import FormatError
from orbiframe.files.lock import file_lock
from orbiframe.files.map_file import load_map, save_map
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.planes.geometry import Geometry
from orbiframe.triangulations.triangulation import Triangulation

_IN_MEMORY = 4


class KeptMaps:
    """Maps in a folder, each in a file named by the content that it depends on; the last few stay in memory.

    Any number of processes may share the folder: of those that want the same map at once, one computes it and the
    others wait. A file that is damaged is made again; where none can be written, maps are computed as without it.
    folder: None for maps in memory only.
    computed, kept: how many maps were computed here, and how many were there.
    """

    def __init__(self, folder: Path | None) -> None:
        self.folder, self.computed, self.kept = folder, 0, 0
        self._memory: OrderedDict[str, Triangulation] = OrderedDict()

    def __call__(
        self, key: str, mesh: Polyhedron, geometry: Geometry, make: Callable[[], Triangulation]
    ) -> Triangulation:
        """The map of a mesh with this key: from memory, from its file, or made now."""
        found = self._memory.pop(key, None)
        if found is not None:
            self.kept += 1
        elif self.folder is None:
            found = make()
            self.computed += 1
        else:
            found = self._of_file_or_made(self.folder / key[:2] / f"{key}.npz", mesh, geometry, make)
        self._memory[key] = replace(found, polyhedron=mesh)  # without what was derived from it
        while len(self._memory) > _IN_MEMORY:
            self._memory.popitem(last=False)
        return self._memory[key]

    def _of_file_or_made(
        self, path: Path, mesh: Polyhedron, geometry: Geometry, make: Callable[[], Triangulation]
    ) -> Triangulation:
        with suppress(FormatError):
            return self._read(path, mesh, geometry)
        with ExitStack() as held:
            with suppress(OSError, FormatError):
                path.parent.mkdir(parents=True, exist_ok=True)
                held.enter_context(file_lock(path.with_suffix(".lock")))
                return self._read(path, mesh, geometry)
            return self._made(path, mesh, make)

    def _read(self, path: Path, mesh: Polyhedron, geometry: Geometry) -> Triangulation:
        found = load_map(path, mesh, geometry)
        self.kept += 1
        return found

    def _made(self, path: Path, mesh: Polyhedron, make: Callable[[], Triangulation]) -> Triangulation:
        found = make()
        self.computed += 1
        if found.polyhedron is mesh and found.density is None:
            with suppress(FormatError):
                save_map(found, path)
        return found
