"""Reader: the triangles of a file that Open3D can read."""

from __future__ import annotations

from pathlib import Path

from orbiframe import Polyhedron, confined_read


def read(path: Path, *, seconds: float = 600.0) -> Polyhedron:
    """The triangles of a file, read by Open3D in a process of its own; equal corners become one vertex.

    seconds: the most time that it may take. Raises FormatError where Open3D fails or finds nothing; PluginError
    where it is not installed or lacks a system library.
    """
    return confined_read("orbiframe_open3d.triangles:polyhedron_of", path, seconds=seconds)
