"""OBJ writer: polygons in the text format of Wavefront."""

from __future__ import annotations

from pathlib import Path

from orbiframe import Polyhedron
from orbiframe_polygons.lines import columns_of, faces_text, save, table_text
from orbiframe_polygons.loss import tell_loss


def write(path: Path, polyhedron: Polyhedron) -> None:
    """Write polygons, normals and vertex colours (`v x y z r g b`), each number with the digits that round-trip.

    OBJ holds no opacity and no colours of faces: a warning says what was left out.
    """
    colors = polyhedron.colors
    tell_loss(path, "colours of faces", polyhedron.face_colors is not None)
    tell_loss(path, "opacity", colors is not None and colors.shape[1] > 3)
    solid = None if colors is None else colors[:, :3]
    normals = polyhedron.normals
    vertices = table_text(columns_of(polyhedron.vertices, solid), start="v ")
    directions = [] if normals is None else [table_text(columns_of(normals), start="vn ")]
    save(path, [], vertices, *directions, faces_text(polyhedron, lead="f", first=1, twice=normals is not None))
