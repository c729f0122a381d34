"""VTU files with rational Bezier triangles."""

from __future__ import annotations

import base64
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import OrbifoldSurface, triangle_patches

Ints = NDArray[np.intp]

_BEZIER_TRIANGLE = 76
_NAMES = {"<f8": "Float64", "<i8": "Int64", "|u1": "UInt8"}


def write_bezier_vtu(path: Path, surface: OrbifoldSurface) -> None:
    """Every micro triangle of the surface as one cell VTK_BEZIER_TRIANGLE with RationalWeights: the exact surface.

    Raises FitError for a surface without exact patches.
    """
    patches = triangle_patches(surface)
    order = vtk_order(patches.degree)
    points = patches.points[:, order].reshape(-1, 3)
    cells, size = len(patches.points), len(order)
    arrays = (
        ("<Points>", _array("Points", points, 3), "</Points>"),
        (
            '<PointData RationalWeights="RationalWeights">',
            _array("RationalWeights", patches.weights[:, order].ravel()),
            "</PointData>",
        ),
        (
            "<Cells>",
            _array("connectivity", np.arange(cells * size)),
            _array("offsets", size * np.arange(1, cells + 1)),
            _array("types", np.full(cells, _BEZIER_TRIANGLE, dtype=np.uint8)),
            "</Cells>",
        ),
    )
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="2.2" byte_order="LittleEndian" header_type="UInt64">',
        "<UnstructuredGrid>",
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{cells}">',
        *(line for part in arrays for line in part),
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


@lru_cache(maxsize=32)
def vtk_order(degree: int) -> Ints:
    """The numbers of our coefficients in the order of VTK: corners, edges, then the triangle inside in the same way."""
    return np.array([_number(*place) for place in _places(degree, 0)], dtype=np.intp)


def _number(_first: int, second: int, third: int) -> int:
    s = second + third
    return s * (s + 1) // 2 + third


def _places(degree: int, inset: int) -> list[tuple[int, int, int]]:
    """Exponents of the triangle that is `inset` steps inside, corner by corner, edge by edge, ring by ring."""
    side = degree - 3 * inset
    if side < 0:
        return []
    if side == 0:
        return [(inset, inset, inset)]
    top, ends = side + inset, ((0, 1), (1, 2), (2, 0))
    ring = [_place(inset, {c: top}) for c in range(3)]
    for start, end in ends:
        ring += [_place(inset, {start: top - k, end: inset + k}) for k in range(1, side)]
    return ring + _places(degree, inset + 1)


def _place(inset: int, entries: dict[int, int]) -> tuple[int, int, int]:
    first, second, third = (entries.get(c, inset) for c in range(3))
    return first, second, third
