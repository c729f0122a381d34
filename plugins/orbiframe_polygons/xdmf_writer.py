"""XDMF writer: polygons in the XML format of the eXtensible Data Model, with the numbers inside."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from orbiframe import Polyhedron
from orbiframe_polygons.lines import columns_of, faces_text, save, table_text
from orbiframe_polygons.loss import tell_loss

KINDS = {3: "Triangle", 4: "Quadrilateral"}
CODES = {3: "4", 4: "5"}


def write(path: Path, polyhedron: Polyhedron) -> None:
    """Write polygons, each number with the digits that round-trip: one kind of cell, or a mixture.

    Normals and colours are left out, with a warning.
    """
    coloured = polyhedron.colors is not None or polyhedron.face_colors is not None
    tell_loss(path, "colours", coloured)
    tell_loss(path, "normals of vertices", polyhedron.normals is not None)
    count = len(polyhedron.vertices)
    head = [
        '<?xml version="1.0"?>',
        '<Xdmf Version="3.0"><Domain><Grid Name="polyhedron" GridType="Uniform"><Geometry GeometryType="XYZ">',
        f'<DataItem DataType="Float" Precision="8" Dimensions="{count} 3" Format="XML">',
    ]
    save(path, head, table_text(columns_of(polyhedron.vertices)), _topology(polyhedron))


def _topology(polyhedron: Polyhedron) -> Iterator[bytes]:
    sizes = np.unique(polyhedron.face_sizes).tolist()
    faces = polyhedron.face_count
    if len(sizes) == 1:
        size = sizes[0]
        kind = f'"{KINDS[size]}"' if size in KINDS else f'"Polygon" NodesPerElement="{size}"'
        shape, rows = f"{faces} {size}", faces_text(polyhedron, lead="")
    else:
        kind, shape = '"Mixed"', str(len(polyhedron.tail) + faces + int((polyhedron.face_sizes > 4).sum()))
        rows = _mixed(polyhedron)
    yield (
        f'</DataItem></Geometry><Topology TopologyType={kind} NumberOfElements="{faces}">\n'
        f'<DataItem DataType="Int" Precision="8" Dimensions="{shape}" Format="XML">\n'
    ).encode("ascii")
    yield from rows
    yield b"</DataItem></Topology></Grid></Domain></Xdmf>\n"


def _mixed(polyhedron: Polyhedron) -> Iterator[bytes]:
    """One line for each face: the code of its cell, of a polygon its size, and its corners."""
    for face in range(polyhedron.face_count):
        corners = polyhedron.face_corners(face).tolist()
        yield f"{CODES.get(len(corners), f'3 {len(corners)}')} {' '.join(map(str, corners))}\n".encode("ascii")
