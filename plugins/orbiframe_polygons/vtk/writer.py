"""VTK writer: polygons as .vtp and .vtu in XML, and as legacy .vtk."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe_polygons.lines import columns_of, faces_text, save, table_text
from orbiframe_polygons.loss import tell_loss
from orbiframe_polygons.vtk.cells import POLYGON, QUAD, TRIANGLE

NAMES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8"}
KINDS = {3: TRIANGLE, 4: QUAD}


def write(path: Path, polyhedron: Polyhedron, *, ascii: bool = False) -> None:
    """Write polygons, coordinates as float64: a .vtp holds PolyData, a .vtu and a .vtk an UnstructuredGrid.

    ascii: numbers as text, with the digits that round-trip. Normals and colours are left out, with a warning.
    """
    tell_loss(path, "colours", polyhedron.colors is not None or polyhedron.face_colors is not None)
    tell_loss(path, "normals of vertices", polyhedron.normals is not None)
    suffix = path.suffix.lower()
    if suffix in (".vtp", ".vtu"):
        path.write_text(_xml(polyhedron, suffix == ".vtp", ascii), encoding="ascii", newline="\n")
    else:
        (_legacy_text if ascii else _legacy_binary)(path, polyhedron)


def _types(polyhedron: Polyhedron) -> NDArray[np.int64]:
    kinds = np.full(polyhedron.face_count, POLYGON, dtype=np.int64)
    for size, kind in KINDS.items():
        kinds[polyhedron.face_sizes == size] = kind
    return kinds


# ---- XML ----------------------------------------------------------------------------------------------------------


def _xml(polyhedron: Polyhedron, surface: bool, ascii: bool) -> str:
    kind, part, count = ("PolyData", "Polys", "Polys") if surface else ("UnstructuredGrid", "Cells", "Cells")
    arrays = {"connectivity": polyhedron.tail, "offsets": polyhedron.offsets[1:]}
    if not surface:
        arrays["types"] = _types(polyhedron).astype(np.uint8)
    lines = [
        '<?xml version="1.0"?>',
        f'<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        f'<{kind}><Piece NumberOfPoints="{len(polyhedron.vertices)}" NumberOf{count}="{polyhedron.face_count}">',
        f"<Points>{_array('Points', polyhedron.vertices, ascii, components=3)}</Points>",
        f"<{part}>",
        *(_array(name, values, ascii) for name, values in arrays.items()),
        f"</{part}>",
        f"</Piece></{kind}>",
        "</VTKFile>",
    ]
    return "\n".join([*lines, ""])


def _array(name: str, values: NDArray[Any], ascii: bool, *, components: int = 1) -> str:
    """A DataArray as text, or in base64 with its length in bytes before it."""
    kind = "f8" if values.dtype.kind == "f" else "u1" if values.dtype == np.uint8 else "i8"
    head = f'<DataArray type="{NAMES[kind]}" Name="{name}" NumberOfComponents="{components}"'
    if ascii:
        return f'{head} format="ascii">\n{" ".join(map(repr, values.ravel().tolist()))}\n</DataArray>'
    data = np.ascontiguousarray(values, dtype=f"<{kind}").tobytes()
    text = base64.b64encode(np.array([len(data)], dtype="<u8").tobytes() + data).decode("ascii")
    return f'{head} format="binary">{text}</DataArray>'


# ---- legacy -------------------------------------------------------------------------------------------------------


def _head(polyhedron: Polyhedron, mode: str) -> list[str]:
    return ["# vtk DataFile Version 3.0", "orbiframe", mode, "DATASET UNSTRUCTURED_GRID",
            f"POINTS {len(polyhedron.vertices)} double"]  # fmt: skip


def _middle(polyhedron: Polyhedron) -> bytes:
    return f"CELLS {polyhedron.face_count} {polyhedron.face_count + len(polyhedron.tail)}\n".encode()


def _legacy_text(path: Path, polyhedron: Polyhedron) -> None:
    save(
        path,
        _head(polyhedron, "ASCII"),
        table_text(columns_of(polyhedron.vertices)),
        [_middle(polyhedron)],
        faces_text(polyhedron),
        [f"CELL_TYPES {polyhedron.face_count}\n".encode()],
        table_text([_types(polyhedron)]),
    )


def _legacy_binary(path: Path, polyhedron: Polyhedron) -> None:
    lists = np.insert(polyhedron.tail, polyhedron.offsets[:-1], polyhedron.face_sizes).astype(">i4")
    save(
        path,
        _head(polyhedron, "BINARY"),
        [polyhedron.vertices.astype(">f8").tobytes(), b"\n", _middle(polyhedron), lists.tobytes(), b"\n"],
        [f"CELL_TYPES {polyhedron.face_count}\n".encode(), _types(polyhedron).astype(">i4").tobytes(), b"\n"],
    )
