"""Reader: the triangles of a file that Open3D can read."""

from __future__ import annotations

from pathlib import Path

from orbiframe import Polyhedron
from orbiframe.files import confined_read

# Open3D takes address space for its threads.
MEMORY = 2**33


def read(path: Path, *, seconds: float = 60.0) -> Polyhedron:
    """The triangles of a file, read by Open3D in a process of its own; equal corners become one vertex.

    seconds: the most time that it may take for a small file; each megabyte adds a second. Raises FormatError where
    Open3D fails or finds nothing; PluginError where it is not installed or lacks a system library.
    """
    return confined_read("orbiframe_open3d.triangles:polyhedron_of", path, seconds=seconds, memory=MEMORY)
