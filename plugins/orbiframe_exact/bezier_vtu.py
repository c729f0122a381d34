"""VTU files with rational Bezier triangles."""

from __future__ import annotations

import base64
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import OrbifoldSurface
from orbiframe.surfaces import PeriodicPatch, patches_of

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_BEZIER_TRIANGLE, _BEZIER_QUADRILATERAL = 76, 77
_NAMES = {"<f8": "Float64", "<i8": "Int64", "|u1": "UInt8"}


def write_bezier_vtu(path: Path, surface: OrbifoldSurface) -> None:
    """Every polynomial piece of the surface as one cell with RationalWeights: the exact surface.

    VTK_BEZIER_TRIANGLE, or VTK_BEZIER_QUADRILATERAL for tensor products. Raises FitError for a surface without exact
    patches.
    """
    patches = patches_of(surface)
    if isinstance(patches, PeriodicPatch):
        pieces = patches.quadrilaterals()
        count, order = len(pieces.points), quadrilateral_order(pieces.degree)
        points, weights = pieces.points.reshape(count, -1, 3), pieces.weights.reshape(count, -1)
        text = _vtu(_BEZIER_QUADRILATERAL, points[:, order], weights[:, order])
    else:
        order = triangle_order(patches.degree)
        text = _vtu(_BEZIER_TRIANGLE, patches.points[:, order], patches.weights[:, order])
    Path(path).write_text(text, encoding="ascii")


def _vtu(kind: int, points: Floats, weights: Floats) -> str:
    """The file of cells of one kind, with points (N, n, 3) and weights (N, n) of their own."""
    cells, size = weights.shape
    arrays = (
        ("<Points>", _array("Points", points.reshape(-1, 3), 3), "</Points>"),
        (
            '<PointData RationalWeights="RationalWeights">',
            _array("RationalWeights", weights.ravel()),
            "</PointData>",
        ),
        (
            "<Cells>",
            _array("connectivity", np.arange(cells * size)),
            _array("offsets", size * np.arange(1, cells + 1)),
            _array("types", np.full(cells, kind, dtype=np.uint8)),
            "</Cells>",
        ),
    )
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="2.2" byte_order="LittleEndian" header_type="UInt64">',
        "<UnstructuredGrid>",
        f'<Piece NumberOfPoints="{weights.size}" NumberOfCells="{cells}">',
        *(line for part in arrays for line in part),
        "</Piece>",
        "</UnstructuredGrid>",
        "</VTKFile>",
    ]
    return "\n".join(lines) + "\n"


def _array(name: str, values: NDArray[Any], components: int = 1) -> str:
    """A DataArray in base64 with its length in bytes before it."""
    kind = "<f8" if values.dtype.kind == "f" else "|u1" if values.dtype == np.uint8 else "<i8"
    data = np.ascontiguousarray(values, dtype=kind).tobytes()
    text = base64.b64encode(np.array([len(data)], dtype="<u8").tobytes() + data).decode("ascii")
    attributes = f'type="{_NAMES[kind]}" Name="{name}" NumberOfComponents="{components}" format="binary"'
    return f"<DataArray {attributes}>{text}</DataArray>"


@lru_cache(maxsize=32)
def quadrilateral_order(degree: int) -> Ints:
    """The numbers (d + 1) s + t in the order of VTK: corners, edges that run along s and t, inside."""
    d, inner = degree, range(1, degree)
    corners = [(0, 0), (d, 0), (d, d), (0, d)]
    edges = [[(k, 0) for k in inner], [(d, k) for k in inner], [(k, d) for k in inner], [(0, k) for k in inner]]
    places = [*corners, *(place for edge in edges for place in edge), *((s, t) for t in inner for s in inner)]
    return np.array([(d + 1) * s + t for s, t in places], dtype=np.intp)


@lru_cache(maxsize=32)
def triangle_order(degree: int) -> Ints:
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
