"""OFF writer: the Object File Format of Geomview, in text."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from orbiframe import Polyhedron
from orbiframe_polygons.lines import face_lines, joined, rows, save


def write(path: Path, polyhedron: Polyhedron) -> None:
    """Write polygons, normals and colours of vertices and faces, each number with the digits that round-trip.

    The header is OFF, NOFF, COFF or CNOFF, by what the polyhedron has. Colours count to 1.
    """
    header = f"{'C' * (polyhedron.colors is not None)}{'N' * (polyhedron.normals is not None)}OFF"
    counts = f"{len(polyhedron.vertices)} {polyhedron.face_count} {polyhedron.edge_count}"
    columns = [a for a in (polyhedron.vertices, polyhedron.normals, polyhedron.colors) if a is not None]
    faces = joined(face_lines(polyhedron), polyhedron.face_colors)
    save(path, [header, counts, *rows(np.hstack(columns)), *faces])
