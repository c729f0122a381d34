"""VTU text: polygons with numbers at their vertices as an UnstructuredGrid of VTK."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron

NAMES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8"}
# Numbers of VTK's kinds of cells by their corners; more corners are a polygon.
KINDS = {3: 5, 4: 9}
POLYGON = 7


def vtu_text(mesh: Polyhedron, columns: Mapping[str, NDArray[np.float64]]) -> str:
    """The XML; columns: (V,) or (V, 3) by name.

    Source: VTK File Formats, "XML File Formats".
    """
    kinds = np.array([KINDS.get(size, POLYGON) for size in mesh.face_sizes.tolist()], dtype=np.uint8)
    cells: dict[str, NDArray[Any]] = {"connectivity": mesh.tail, "offsets": mesh.offsets[1:], "types": kinds}
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        f'<UnstructuredGrid><Piece NumberOfPoints="{len(mesh.vertices)}" NumberOfCells="{mesh.face_count}">',
        "<PointData>",
        *(_array(name, values) for name, values in columns.items()),
        "</PointData>",
        f"<Points>{_array('Points', mesh.vertices)}</Points>",
        "<Cells>",
        *(_array(name, values) for name, values in cells.items()),
        "</Cells>",
        "</Piece></UnstructuredGrid>",
        "</VTKFile>",
    ]
    return "\n".join([*lines, ""])


def _array(name: str, values: NDArray[Any]) -> str:
    """A DataArray in base64 with its length in bytes before it."""
    kind = "f8" if values.dtype.kind == "f" else "u1" if values.dtype == np.uint8 else "i8"
    components = "" if values.ndim == 1 else f' NumberOfComponents="{values.shape[1]}"'
    data = np.ascontiguousarray(values, dtype=f"<{kind}").tobytes()
    text = base64.b64encode(np.array([len(data)], dtype="<u8").tobytes() + data).decode("ascii")
    head = f'<DataArray type="{NAMES[kind]}" Name="{name}"{components} format="binary">'
    return f"{head}{text}</DataArray>"
