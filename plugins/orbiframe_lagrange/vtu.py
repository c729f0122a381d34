"""VTU files with Lagrange triangles."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.surfaces import CurvedMesh

_TRIANGLE, _LAGRANGE_TRIANGLE = 5, 69
_NAMES = {"<f8": "Float64", "<i8": "Int64", "|u1": "UInt8"}


def write(path: Path, mesh: CurvedMesh) -> None:
    """The triangles as cells VTK_LAGRANGE_TRIANGLE (VTK_TRIANGLE for order 1), with all digits."""
    cells, size = mesh.elements.shape
    kind = _TRIANGLE if mesh.order == 1 else _LAGRANGE_TRIANGLE
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="2.2" byte_order="LittleEndian" header_type="UInt64">',
        "<UnstructuredGrid>",
        f'<Piece NumberOfPoints="{len(mesh.nodes)}" NumberOfCells="{cells}">',
        "<Points>",
        _array("Points", mesh.nodes, 3),
        "</Points>",
        "<Cells>",
        _array("connectivity", mesh.elements.ravel()),
        _array("offsets", size * np.arange(1, cells + 1)),
        _array("types", np.full(cells, kind, dtype=np.uint8)),
        "</Cells>",
        "</Piece>",
        "</UnstructuredGrid>",
        "</VTKFile>",
    ]
    Path(path).write_text("\n".join(lines) + "\n", encoding="ascii")


def _array(name: str, values: NDArray[Any], components: int = 1) -> str:
    """A DataArray in base64 with its length in bytes before it."""
    kind = "<f8" if values.dtype.kind == "f" else "|u1" if values.dtype == np.uint8 else "<i8"
    data = np.ascontiguousarray(values, dtype=kind).tobytes()
    text = base64.b64encode(np.array([len(data)], dtype="<u8").tobytes() + data).decode("ascii")
    attributes = f'type="{_NAMES[kind]}" Name="{name}" NumberOfComponents="{components}" format="binary"'
    return f"<DataArray {attributes}>{text}</DataArray>"
