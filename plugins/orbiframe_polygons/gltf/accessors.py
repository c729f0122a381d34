"""Accessors: tables of numbers in the buffers of a glTF, strided, sparse or normalised."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe_polygons.gltf.container import Container
from orbiframe_polygons.gltf.tree import Node
from orbiframe_polygons.room import Budget

Array = NDArray[Any]

TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
COMPRESSED = ("EXT_meshopt_compression", "KHR_meshopt_compression")


class Accessors:
    """The accessors of a glTF by number."""

    def __init__(self, container: Container) -> None:
        self._container = container
        self._budget = Budget(container.path, "its accessors repeat their numbers")

    @cached_property
    def nodes(self) -> list[Node]:
        """The accessors as the JSON describes them."""
        return self._container.root.children("accessors")

    @cached_property
    def _views(self) -> list[Node]:
        return self._container.root.children("bufferViews")

    def table(self, number: int, kinds: tuple[str, ...], types: str) -> Array:
        """The numbers of an accessor, (count, width); normalised ones from -1 or 0 to 1.

        kinds: the allowed shapes, such as VEC3; types: the allowed kinds of numbers, of "i", "u" and "f". Raises
        FormatError for others, and for numbers that are not inside their buffers.
        """
        node = self.nodes[number]
        kind, code = node.word("type"), node.index("componentType")
        if kind not in kinds or code not in TYPES or TYPES[code][1] not in types:
            node.refuse(
                f"the type {kind[:20]!r} of components {code} is not read here; {' or '.join(kinds)} is required"
            )
        raw = self._dense(node, TYPES[code], WIDTHS[kind])
        if node.has("sparse"):
            raw = self._patched(node, raw, TYPES[code])
        return normalised(raw) if node.flag("normalized") else raw

    def _dense(self, node: Node, dtype: str, width: int) -> Array:
        count = node.index("count")
        self._budget.spend(count * width)
        if not node.has("bufferView"):
            if not node.has("sparse"):
                node.refuse("there are no numbers (no bufferView); is the mesh compressed?")
            return np.zeros((count, width), dtype)
        return self._strided(node, node.index("bufferView"), node.index("byteOffset", 0), dtype, (count, width))

    def _strided(self, node: Node, view: int, offset: int, dtype: str, shape: tuple[int, int]) -> Array:
        data, stride = self._view(node, view)
        count, width = shape
        item = np.dtype(dtype).itemsize
        step = stride or width * item
        if step < width * item:
            node.refuse(f"rows of {width * item} bytes stand {step} bytes apart, so they overlap")
        if count and offset + (count - 1) * step + width * item > len(data):
            node.refuse(f"{count} rows from byte {offset} do not fit into the {len(data)} bytes of the view {view}")
        if not count:
            return np.empty(shape, dtype)
        used = data[offset : offset + (count - 1) * step + width * item]
        return np.ndarray(shape, dtype, used, strides=(step, item))

    def _view(self, node: Node, number: int) -> tuple[bytes, int]:
        """The bytes of a view, and how far apart its rows are; 0 for close together."""
        if number >= len(self._views):
            node.refuse(f"names the view {number}, but there are only {len(self._views)}")
        view = self._views[number]
        extensions = view.child("extensions")
        buffer = view.index("buffer", most=max(0, len(self._container.buffers) - 1))
        for name in COMPRESSED:
            if extensions.has(name) and not self._container.buffers[buffer].has("uri"):
                view.refuse(f"it is compressed with {name}, which is not read; save the mesh without compression")
        if not self._container.buffers:
            view.refuse("there are no buffers")
        first, size = view.index("byteOffset", 0), view.index("byteLength")
        data = self._container.buffer(buffer)
        if first + size > len(data):
            view.refuse(f"bytes {first} to {first + size} are not in the buffer, which has {len(data)}")
        return data[first : first + size], view.index("byteStride", 0, most=252)

    def _patched(self, node: Node, raw: Array, dtype: str) -> Array:
        """The table with the rows that a sparse accessor replaces."""
        sparse = node.child("sparse")
        count = sparse.index("count", most=len(raw))
        at, new = sparse.child("indices"), sparse.child("values")
        code = at.index("componentType")
        if code not in (5121, 5123, 5125):
            at.refuse(f"the components {code} are no indices")
        rows = self._strided(at, at.index("bufferView"), at.index("byteOffset", 0), TYPES[code], (count, 1)).ravel()
        if (np.diff(rows.astype(np.int64)) <= 0).any() or (count and rows[-1] >= len(raw)):
            at.refuse(f"the indices must rise and stay below {len(raw)}")
        values = self._strided(new, new.index("bufferView"), new.index("byteOffset", 0), dtype, (count, raw.shape[1]))
        made = raw.copy()
        made[rows] = values
        return made


def normalised(raw: Array) -> Array:
    """Whole numbers as numbers from -1 or 0 to 1; floats as they are.

    Source: glTF 2.0, section 3.6.2.2.
    """
    if raw.dtype.kind == "f":
        return raw
    return np.maximum(raw / float(np.iinfo(raw.dtype).max), -1.0)
