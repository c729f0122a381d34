"""Primitives: the triangles of one mesh of a glTF, in lists, strips or fans."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from orbiframe_polygons.faces import corners
from orbiframe_polygons.gltf.accessors import Accessors
from orbiframe_polygons.gltf.tree import Node
from orbiframe_polygons.parts import Part
from orbiframe_polygons.strips import triangles_of_strips

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

TRIANGLES, STRIP, FAN = 4, 5, 6
BELOW = {0: "points", 1: "lines", 2: "lines", 3: "lines"}
DRACO = "KHR_draco_mesh_compression"


@dataclass(frozen=True, slots=True)
class Shape:
    """A mesh of a glTF: its parts, and how many points and lines were passed over."""

    parts: tuple[Part, ...]
    skipped: tuple[str, ...]


def shape_of(mesh: Node, accessors: Accessors, weights: Floats, *, quantized: bool) -> Shape:
    """The triangles of all primitives of a mesh, moved by its morph targets times their weights."""
    primitives = mesh.children("primitives")
    if not primitives:
        mesh.refuse("the mesh has no primitives")
    kinds = [primitive.index("mode", TRIANGLES, most=FAN) for primitive in primitives]
    parts = [
        _part(primitive, kind, accessors, weights, quantized=quantized)
        for primitive, kind in zip(primitives, kinds, strict=True)
        if kind not in BELOW
    ]
    return Shape(tuple(part for part in parts if len(part.sizes)), tuple(BELOW[k] for k in kinds if k in BELOW))


def _part(primitive: Node, kind: int, accessors: Accessors, weights: Floats, *, quantized: bool) -> Part:
    attributes = primitive.child("attributes")
    if primitive.child("extensions").has(DRACO):
        _require_uncompressed(primitive, attributes, accessors)
    types = "iuf" if quantized else "f"
    points = _table(attributes, "POSITION", accessors, ("VEC3",), types)
    if points is None:
        primitive.refuse("the primitive has no POSITION")
    normals = _table(attributes, "NORMAL", accessors, ("VEC3",), "if" if quantized else "f", len(points))
    colors = _table(attributes, "COLOR_0", accessors, ("VEC3", "VEC4"), "uf", len(points))
    texture = _table(attributes, "TEXCOORD_0", accessors, ("VEC2",), "uf", len(points))
    points, normals = _morphed(primitive, accessors, weights, types, points, normals)
    triangles = _triangles(primitive, kind, accessors, len(points))
    sizes = np.full(len(triangles), 3, dtype=np.intp)
    corners = triangles.ravel()
    # Textures of glTF count from the upper left corner down.
    uv = None if texture is None else texture[corners] * (1, -1) + (0, 1)
    return Part(points, sizes, corners, normals, None if colors is None else np.clip(colors, 0, 1), uv)


def _require_uncompressed(primitive: Node, attributes: Node, accessors: Accessors) -> None:
    used = [_accessor(attributes, name, accessors) for name in ("POSITION",) if attributes.has(name)]
    if not used or not accessors.nodes[used[0]].has("bufferView"):
        primitive.refuse(f"it is compressed with {DRACO}, which is not read; save the mesh without compression")


def _accessor(node: Node, key: str, accessors: Accessors) -> int:
    if not accessors.nodes:
        node.refuse(f"'{key}' names an accessor, but there is none")
    return node.index(key, most=len(accessors.nodes) - 1)


def _table(
    node: Node, name: str, accessors: Accessors, kinds: tuple[str, ...], types: str, rows: int | None = None
) -> Floats | None:
    """The numbers of an attribute, as many rows as there are points; None where it is missing."""
    if not node.has(name):
        return None
    found = accessors.table(_accessor(node, name, accessors), kinds, types).astype(np.float64)
    if rows is not None and len(found) != rows:
        node.refuse(f"'{name}' has {len(found)} rows, but there are {rows} points")
    if not np.isfinite(found).all():
        bad = int(np.flatnonzero(~np.isfinite(found).all(axis=1))[0])
        node.refuse(f"'{name}' holds a number in row {bad} that is not finite")
    return found


def _morphed(
    primitive: Node, accessors: Accessors, weights: Floats, types: str, points: Floats, normals: Floats | None
) -> tuple[Floats, Floats | None]:
    """The points and normals after all morph targets have been added."""
    targets = primitive.children("targets")
    if len(weights) and len(weights) != len(targets):
        primitive.refuse(f"there are {len(weights)} weights for {len(targets)} morph targets")
    for target, weight in zip(targets, weights.tolist(), strict=False):
        if weight:
            moves = _table(target, "POSITION", accessors, ("VEC3",), types, len(points))
            turns = _table(target, "NORMAL", accessors, ("VEC3",), "if", len(points))
            points = points if moves is None else points + weight * moves
            normals = normals if turns is None or normals is None else normals + weight * turns
    return points, normals


def _triangles(primitive: Node, kind: int, accessors: Accessors, count: int) -> Ints:
    """The corners of all triangles, (F, 3); in strips those that are none are left out, as they only turn it."""
    order = np.arange(count)
    if primitive.has("indices"):
        raw = accessors.table(_accessor(primitive, "indices", accessors), ("SCALAR",), "u").ravel()
        order = corners(raw, np.array([len(raw)]), count, lambda _: f"{primitive.path}: {primitive.place}")
    if kind == TRIANGLES:
        if len(order) % 3:
            primitive.refuse(f"there are {len(order)} corners, which are no triangles")
        return order.reshape(-1, 3)
    if len(order) < 3:
        primitive.refuse(f"there are {len(order)} corners, but a strip or fan has 3 at least")
    return triangles_of_strips(order) if kind == STRIP else _fan_triangles(order)


def _fan_triangles(order: Ints) -> Ints:
    k = np.arange(len(order) - 2)
    return order[np.stack([k + 1, k + 2, np.zeros_like(k)], axis=1)]


def with_colours_of_all(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    """The parts, their colours opaque where some have four components and others three."""
    widths = {part.colors.shape[1] for part in parts if part.colors is not None}
    if len(widths) < 2:
        return parts
    return tuple(_opaque(part) for part in parts)


def _opaque(part: Part) -> Part:
    if part.colors is None or part.colors.shape[1] == 4:
        return part
    return replace(part, colors=np.pad(part.colors, ((0, 0), (0, 1)), constant_values=1))
