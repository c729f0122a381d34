"""OBJ writer: polygons in the text format of Wavefront."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from orbiframe import Polyhedron
from orbiframe_polygons.lines import joined, rows, save
from orbiframe_polygons.loss import tell_loss


def write(path: Path, polyhedron: Polyhedron) -> None:
    """Write polygons, normals and vertex colours (`v x y z r g b`), each number with the digits that round-trip.

    OBJ holds no opacity and no colours of faces: a warning says what was left out.
    """
    colors = polyhedron.colors
    tell_loss(path, "colours of faces", polyhedron.face_colors is not None)
    tell_loss(path, "opacity", colors is not None and colors.shape[1] > 3)
    vertices = joined(rows(polyhedron.vertices), None if colors is None else colors[:, :3])
    normals = iter(()) if polyhedron.normals is None else (f"vn {row}" for row in rows(polyhedron.normals))
    save(path, [*(f"v {row}" for row in vertices), *normals, *_faces(polyhedron)])


def _faces(polyhedron: Polyhedron) -> Iterator[str]:
    corner = "{0}" if polyhedron.normals is None else "{0}//{0}"
    words = [corner.format(k) for k in (polyhedron.tail + 1).tolist()]
    offsets = polyhedron.offsets.tolist()
    return (f"f {' '.join(words[a:b])}" for a, b in pairwise(offsets))
