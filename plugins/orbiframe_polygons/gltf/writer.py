"""glTF writer: triangles with normals and colours, all in one file."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Polyhedron
from orbiframe.files import require_triangles
from orbiframe_polygons.gltf.container import BINARY, CHUNK, JSON, START
from orbiframe_polygons.loss import tell_loss
from orbiframe_polygons.units import in_unit

Array = NDArray[Any]

CODES = {"u1": 5121, "u2": 5123, "u4": 5125, "f4": 5126}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
# What a view of a buffer is for.
ATTRIBUTES, INDICES = 34962, 34963
# Many programs look for points of a texture only where there is a material.
MATERIAL = {"name": "surface", "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.8}}
LARGEST = float(np.finfo(np.float32).max)


def write(path: Path, polyhedron: Polyhedron) -> None:
    """Write triangles, unit normals and colours of vertices, numbers as float32; a .gltf holds its buffer itself.

    Vertices whose corners have different points of a texture, or different normals, as beside creases, are written once
    for each of these.

    Coordinates in millimetres are converted to metres, with a notice; those of no unit are written as they are.

    Raises FormatError for faces that are no triangles and for coordinates beyond float32. Colours of faces, and normals
    of length 0, are left out with a warning.
    """
    polyhedron = in_unit(path, polyhedron, "metre")
    _require_writable(path, polyhedron)
    tell_loss(path, "colours of faces", polyhedron.face_colors is not None)
    polyhedron, texture = _split(polyhedron)
    buffer = _Buffer()
    attributes = {"POSITION": buffer.add(polyhedron.vertices.astype("<f4"), bounds=True)}
    normals = _unit_normals(path, polyhedron)
    if normals is not None:
        attributes["NORMAL"] = buffer.add(normals.astype("<f4"))
    if texture is not None:
        attributes["TEXCOORD_0"] = buffer.add(texture.astype("<f4"))
    if polyhedron.colors is not None:
        attributes["COLOR_0"] = buffer.add(*_colours(polyhedron.colors))
    few = len(polyhedron.vertices) < 2**16
    indices = buffer.add(polyhedron.tail.astype("<u2" if few else "<u4")[:, None], target=INDICES)
    primitive = {"attributes": attributes, "indices": indices, "mode": 4} | ({} if texture is None else {"material": 0})
    tree = {
        "asset": {"version": "2.0", "generator": "orbiframe"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [primitive]}],
        **({} if texture is None else {"materials": [MATERIAL]}),
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
    }
    path.write_bytes(_text(tree, buffer.data) if path.suffix.lower() == ".gltf" else _binary(tree, buffer.data))


def _require_writable(path: Path, polyhedron: Polyhedron) -> None:
    require_triangles(path, polyhedron, "glTF")
    if np.abs(polyhedron.vertices).max(initial=0) > LARGEST:
        raise FormatError(f"{path}: glTF holds numbers to {LARGEST:.2g}, but a coordinate is larger; scale the mesh")


@dataclass(slots=True)
class _Buffer:
    """Tables one after the other, each from a multiple of four bytes on."""

    data: bytearray = field(default_factory=bytearray)
    views: list[dict[str, int]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)

    def add(self, table: Array, scaled: bool = False, *, bounds: bool = False, target: int = ATTRIBUTES) -> int:
        """Put a table (n, width) into the buffer; the number of its accessor. Rows start at multiples of four bytes."""
        kind, (count, width) = table.dtype.str[1:], table.shape
        step = table.dtype.itemsize * width
        stride = step + -step % 4 if target == ATTRIBUTES else step
        rows = np.zeros((count, stride), dtype=np.uint8)
        rows[:, :step] = np.ascontiguousarray(table).view(np.uint8).reshape(count, step)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": rows.size, "target": target}
        self.views.append(view | {"byteStride": stride} if stride != step else view)
        self.data += rows.tobytes() + bytes(-rows.size % 4)
        accessor: dict[str, Any] = {"bufferView": len(self.views) - 1, "componentType": CODES[kind], "count": count}
        accessor["type"] = KINDS[width]
        if scaled:
            accessor["normalized"] = True
        if bounds:
            accessor |= {name: getattr(table, name)(axis=0).astype(float).tolist() for name in ("min", "max")}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _split(polyhedron: Polyhedron) -> tuple[Polyhedron, NDArray[np.float64] | None]:
    """The polyhedron with a vertex for each point of the texture and each normal of corners.

    Also the points of the texture, (V, 2), from the upper left corner down.
    """
    uv, normals = polyhedron.corner_uv, polyhedron.corner_normals
    if uv is None and normals is None:
        return polyhedron, None
    tables = [table for table in (polyhedron.tail[:, None], uv, normals) if table is not None]
    first, number = np.unique(np.concatenate(tables, axis=1), axis=0, return_index=True, return_inverse=True)[1:]
    vertex = polyhedron.tail[first]
    own = polyhedron.normals[vertex] if normals is None and polyhedron.normals is not None else None
    split = Polyhedron.from_corners(
        polyhedron.vertices[vertex],
        polyhedron.offsets,
        number.ravel(),
        normals=own if normals is None else normals[first],
        colors=None if polyhedron.colors is None else polyhedron.colors[vertex],
    )
    return split, None if uv is None else uv[first] * [1.0, -1.0] + [0.0, 1.0]


def _unit_normals(path: Path, polyhedron: Polyhedron) -> NDArray[np.float64] | None:
    if polyhedron.normals is None:
        return None
    length = np.linalg.norm(polyhedron.normals, axis=1, keepdims=True)
    tell_loss(path, "normals of length 0", bool((length == 0).any()))
    return None if (length == 0).any() else polyhedron.normals / length


def _colours(colors: NDArray[np.float64]) -> tuple[Array, bool]:
    """Colours as bytes where they count to 255, and whether they do."""
    steps = np.rint(colors * 255)
    exact = np.array_equal(steps / 255, colors)
    return (steps.astype("u1") if exact else colors.astype("<f4")), exact


def _text(tree: dict[str, Any], data: bytes | bytearray) -> bytes:
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode("ascii")
    return _json(tree | {"buffers": [{"byteLength": len(data), "uri": uri}]}) + b"\n"


def _binary(tree: dict[str, Any], data: bytes | bytearray) -> bytes:
    text = _json(tree | {"buffers": [{"byteLength": len(data)}]})
    text += b" " * (-len(text) % 4)
    size = START.size + 2 * CHUNK.size + len(text) + len(data)
    if size >= 2**32:
        raise FormatError("a binary glTF holds 4 GB at most; write PLY")
    return b"".join(
        [START.pack(b"glTF", 2, size), CHUNK.pack(len(text), JSON), text, CHUNK.pack(len(data), BINARY), bytes(data)]
    )


def _json(tree: dict[str, Any]) -> bytes:
    return json.dumps(tree, separators=(",", ":"), allow_nan=False).encode("ascii")
