"""VTK reader: legacy files and XML files, by what stands in them."""

from __future__ import annotations

from pathlib import Path

from orbiframe import Polyhedron
from orbiframe_polygons.text import MARK
from orbiframe_polygons.vtk import legacy_reader, xml_reader


def read(path: Path) -> Polyhedron:
    """The polygons of a VTK file: see `legacy_reader.read` for .vtk, `xml_reader.read` for .vtp and .vtu.

    Raises FormatError with the line or byte for anything that is not sound or not read.
    """
    with path.open("rb") as file:
        start = file.read(100).removeprefix(MARK).lstrip()
    return xml_reader.read(path) if start.startswith(b"<") else legacy_reader.read(path)
