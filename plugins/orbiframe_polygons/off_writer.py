"""OFF writer: the Object File Format of Geomview, in text."""

from __future__ import annotations

from pathlib import Path

from orbiframe import Polyhedron
from orbiframe_polygons.lines import columns_of, faces_text, save, table_text


def write(path: Path, polyhedron: Polyhedron) -> None:
    """Write polygons, normals and colours of vertices and faces, each number with the digits that round-trip.

    The header is OFF, NOFF, COFF or CNOFF, by what the polyhedron has. Colours count to 1.
    """
    header = f"{'C' * (polyhedron.colors is not None)}{'N' * (polyhedron.normals is not None)}OFF"
    counts = f"{len(polyhedron.vertices)} {polyhedron.face_count} {polyhedron.edge_count}"
    vertices = table_text(columns_of(polyhedron.vertices, polyhedron.normals, polyhedron.colors))
    save(path, [header, counts], vertices, faces_text(polyhedron, columns_of(polyhedron.face_colors)))
