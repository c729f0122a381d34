"""Reader: the polygons of a file that meshio can read."""

from __future__ import annotations

from pathlib import Path

from orbiframe import FormatError, Polyhedron
from orbiframe.files import confined_read

# Read by readers that know all keywords.
OWN = {".inp", ".nas", ".bdf", ".fem", ".msh", ".mesh", ".meshb", ".dat", ".tec"}


def read(path: Path, *, seconds: float = 60.0) -> Polyhedron:
    """The triangles, quads and polygons of a file, read by meshio in a process of its own.

    seconds: the most time that it may take for a small file; each megabyte adds a second. Lines and points are left
    out. Raises FormatError where meshio fails, warns or ends its process, for solid cells, and for XML files with
    entities.
    """
    if path.suffix.lower() in OWN:
        raise FormatError(
            f"{path}: {path.suffix} files hold keywords that meshio passes over; "
            "leave the format away, so that they are read without it"
        )
    return confined_read("orbiframe_meshio.cells:polyhedron_of", path, seconds=seconds)
