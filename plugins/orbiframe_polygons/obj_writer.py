"""OBJ writer: polygons in the text format of Wavefront."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe_polygons.lines import columns_of, faces_text, save, table_text
from orbiframe_polygons.loss import tell_loss

Floats = NDArray[np.float64]


def write(path: Path, polyhedron: Polyhedron) -> None:
    """Write polygons, normals and vertex colours (`v x y z r g b`), each number with the digits that round-trip.

    Beside creases the corners of faces have normals of their own.

    OBJ holds no opacity and no colours of faces: a warning says what was left out.
    """
    colors = polyhedron.colors
    tell_loss(path, "colours of faces", polyhedron.face_colors is not None)
    tell_loss(path, "opacity", colors is not None and colors.shape[1] > 3)
    solid = None if colors is None else colors[:, :3]
    if polyhedron.corner_normals is not None:
        _write_corners(path, polyhedron, polyhedron.corner_normals, solid)
        return
    normals = polyhedron.normals
    vertices = table_text(columns_of(polyhedron.vertices, solid), start="v ")
    directions = [] if normals is None else [table_text(columns_of(normals), start="vn ")]
    save(path, [], vertices, *directions, faces_text(polyhedron, lead="f", first=1, twice=normals is not None))


def _write_corners(path: Path, polyhedron: Polyhedron, normals: Floats, colors: Floats | None) -> None:
    """Polygons whose corners name a vertex and a normal each."""
    different, number = np.unique(normals, axis=0, return_inverse=True)
    words = [f"{v}//{n}" for v, n in zip((polyhedron.tail + 1).tolist(), (number.ravel() + 1).tolist(), strict=True)]
    bounds = polyhedron.offsets.tolist()
    faces = ("f " + " ".join(words[a:b]) + "\n" for a, b in itertools.pairwise(bounds))
    save(
        path,
        [],
        table_text(columns_of(polyhedron.vertices, colors), start="v "),
        table_text(columns_of(different), start="vn "),
        (line.encode("ascii") for line in faces),
    )
