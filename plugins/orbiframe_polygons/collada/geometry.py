"""Geometry: the polygons of one mesh of COLLADA."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from orbiframe_polygons.collada.tree import Element, by_id
from orbiframe_polygons.faces import corners, require_sizes
from orbiframe_polygons.parts import Part
from orbiframe_polygons.strips import RESTART, triangles_of_strips

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

FACES = ("triangles", "polylist", "polygons", "tristrips", "trifans")
BELOW = ("lines", "linestrips")


def part_of(geometry: Element, skipped: Counter[str]) -> Part | None:
    """The polygons of a geometry; None where it has none. Lines are counted in `skipped`."""
    mesh = geometry.first("mesh")
    if mesh is None:
        geometry.refuse("there is no mesh in it; curves and solids are not read")
    points = _positions(mesh)
    lists = []
    for element in mesh.all(*FACES, *BELOW):
        if element.name in BELOW:
            skipped[element.name] += 1
        elif element.count("count", 1):
            lists.append(_faces(element, len(points)))
    if not lists:
        return None
    sizes, tail = (np.concatenate([pair[k] for pair in lists]) for k in (0, 1))
    return Part(points, sizes, tail).closed()


def _positions(mesh: Element) -> Floats:
    """The positions that the vertices of a mesh name."""
    inputs = [i for i in mesh.only("vertices").all("input") if i.attribute("semantic") == "POSITION"]
    if len(inputs) != 1:
        mesh.refuse(f"its vertices name {len(inputs)} sources of positions, but one is required")
    sources = by_id(mesh, "source")
    name = inputs[0].reference("source")
    if name not in sources:
        inputs[0].refuse(f"there is no source {name[:40]!r} in this mesh")
    source = sources[name]
    numbers, accessor = source.only("float_array"), source.only("technique_common").only("accessor")
    values = numbers.numbers()
    if numbers.count("count", len(values)) != len(values):
        numbers.refuse(f"{numbers.attributes['count'][:20]} numbers are declared, but {len(values)} follow")
    if accessor.reference("source") != numbers.attributes.get("id"):
        accessor.refuse("its numbers stand elsewhere, which is not read")
    return _accessed(accessor, values)


def _accessed(accessor: Element, values: Floats) -> Floats:
    count, stride, offset = accessor.count("count"), accessor.count("stride", 1), accessor.count("offset", 0)
    named = [k for k, param in enumerate(accessor.all("param")) if param.attributes.get("name")]
    columns = named if len(named) == 3 else [0, 1, 2]
    if max(columns) >= stride or offset + count * stride > len(values):
        accessor.refuse(f"{count} rows of {stride} numbers from {offset} on do not fit {len(values)} numbers of points")
    return values[offset : offset + count * stride].reshape(count, stride)[:, columns]


def _faces(element: Element, points: int) -> tuple[Ints, Ints]:
    """The sizes and corners of the faces of one primitive."""
    inputs = element.all("input")
    width = 1 + max((i.count("offset") for i in inputs), default=0)
    places = [i.count("offset") for i in inputs if i.attribute("semantic") == "VERTEX"]
    if len(places) != 1 or width > 1000:
        element.refuse("one input VERTEX is required")
    if element.all("ph"):
        element.refuse("faces with holes are not read; triangulate them first")
    lists = [_corners(p, width, places[0]) for p in element.all("p")]
    count = element.count("count", len(lists))
    sizes, order = _sorted_faces(element, lists, count)
    place = f"{element.path}, line {element.line}"
    require_sizes(sizes, lambda _: place)
    if len(sizes) != count and element.name not in ("tristrips", "trifans"):
        element.refuse(f"{count} faces are declared, but there are {len(sizes)}")
    return sizes, corners(order, sizes, points, lambda _: place)


def _corners(element: Element, width: int, place: int) -> Ints:
    numbers = element.whole()
    if len(numbers) % width:
        element.refuse(f"there are {len(numbers)} numbers, but {width} for each corner")
    return numbers[place::width]


def _sorted_faces(element: Element, lists: list[Ints], count: int) -> tuple[Ints, Ints]:
    joined = np.concatenate(lists) if lists else np.empty(0, dtype=np.intp)
    if element.name == "triangles":
        if len(joined) != 3 * count:
            element.refuse(f"{count} triangles are declared, but there are {len(joined)} corners")
        return np.full(count, 3, dtype=np.intp), joined
    if element.name == "polylist":
        sizes = element.only("vcount").whole()
        if len(sizes) != count or sizes.sum() != len(joined) or (sizes < 0).any():
            element.refuse(
                f"{count} polygons are declared, but vcount has {len(sizes)} and there are {len(joined)} corners"
            )
        return sizes, joined
    if len(lists) != count:
        element.refuse(f"{count} lists of corners are declared, but there are {len(lists)}")
    if element.name == "polygons":
        return np.array([len(one) for one in lists], dtype=np.intp), joined
    made = [
        triangles_of_strips(one) if element.name == "tristrips" else _fan(one) for one in lists if RESTART not in one
    ]
    triangles = np.concatenate([np.empty((0, 3), dtype=np.intp), *made])
    return np.full(len(triangles), 3, dtype=np.intp), triangles.ravel()


def _fan(order: Ints) -> Ints:
    k = np.arange(1, len(order) - 1)
    return order[np.stack([np.zeros_like(k), k, k + 1], axis=1)] if len(order) > 2 else np.empty((0, 3), dtype=np.intp)
