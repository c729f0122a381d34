"""COLLADA reader: the polygons of a .dae at the places of their nodes."""

from __future__ import annotations

import math
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, Notice, Polyhedron
from orbiframe_polygons.collada.geometry import part_of
from orbiframe_polygons.collada.tree import Element, by_id, tree
from orbiframe_polygons.parts import Part, polyhedron_of, rotation
from orbiframe_polygons.room import Budget

Floats = NDArray[np.float64]

TRANSFORMS = {"matrix": 16, "translate": 3, "rotate": 4, "scale": 3}
DEPTH = 100


def read(path: Path) -> Polyhedron:
    """The polygons of the scene of a COLLADA file, each mesh moved to the places of its nodes, in metres.

    Another unit is converted, with a notice; which axis is up is left as it is. Where a node mirrors, faces are turned.
    A mesh that has open edges is closed where points are equal. Lines are skipped with a warning; normals, colours,
    materials and pictures are skipped, and no other file is opened. Raises FormatError with the line for meshes that
    are bent by a controller, faces with holes, references to other files, and counts that do not fit.

    Source: Khronos Group, COLLADA 1.4.1 and 1.5.0 Specification.
    """
    root = tree(path)
    scene = _Scene(path, by_id(root, "geometry"), by_id(root, "node"))
    parts = list(scene.placed(_nodes(root), np.eye(4)))
    if not any(True for _ in root.everywhere("visual_scene")):
        parts = [part for part in map(scene.part, scene.geometries) if part is not None]
    for kind, count in sorted(scene.skipped.items()):
        warnings.warn(f"{path.name}: {count} primitives of {kind} are no faces; left out", stacklevel=2)
    if not parts:
        raise FormatError(f"{path}: the scene holds no triangles or polygons")
    scale = _metres(root)
    if scale != 1:
        parts = [part.moved(scale * np.eye(3), np.zeros(3)) for part in parts]
    return polyhedron_of(parts, "metre")


def _nodes(root: Element) -> list[Element]:
    """The nodes of the scene that the file shows, or of its only scene."""
    scenes = by_id(root, "visual_scene")
    shown = [i.reference("url") for i in root.everywhere("instance_visual_scene")]
    if len(shown) > 1 or any(name not in scenes for name in shown):
        raise FormatError(f"{root.path}: the file shows the scenes {shown[:3]}, but one that is there is required")
    listed = [scenes[shown[0]]] if shown else list(root.everywhere("visual_scene"))
    if len(listed) > 1:
        raise FormatError(f"{root.path}: there are {len(listed)} scenes, and none is said to be shown")
    return listed[0].all("node") if listed else []


def _metres(root: Element) -> float:
    """How many metres the unit of the file has."""
    asset = root.first("asset")
    unit = None if asset is None else asset.first("unit")
    if unit is None or "meter" not in unit.attributes:
        return 1.0
    try:
        scale = float(unit.attributes["meter"])
    except ValueError:
        scale = math.nan
    if not 0 < scale < math.inf:
        unit.refuse(f"meter is {unit.attributes['meter'][:20]!r}, but a number above 0 is required")
    if scale != 1:
        name = unit.attributes.get("name", "unit")[:20]
        told = f"the unit is {name}; coordinates are converted to metres (times {scale:g})"
        warnings.warn(f"{root.path.name}: {told}", Notice, stacklevel=3)
    return scale


@dataclass(slots=True)
class _Scene:
    """Geometries and nodes by name, and what was made of them."""

    path: Path
    geometries: dict[str, Element]
    nodes: dict[str, Element]
    skipped: Counter[str] = field(default_factory=Counter)
    _parts: dict[str, Part | None] = field(default_factory=dict)
    _budget: Budget = field(init=False)

    def __post_init__(self) -> None:
        self._budget = Budget(self.path, "its nodes repeat their meshes")

    def placed(self, nodes: list[Element], above: Floats, depth: int = 0) -> Iterator[Part]:
        """The meshes of nodes and of all that they hold, moved; points are rows: (x, y, z, 1) @ matrix."""
        for node in nodes:
            self._budget.spend(1)
            if depth > DEPTH:
                node.refuse("nodes are nested too deeply, or are parts of themselves")
            matrix = _matrix(node) @ above
            for held in node.children:
                if held.name == "instance_geometry":
                    yield from self._moved(held, matrix)
                elif held.name == "instance_controller":
                    held.refuse("the mesh is bent by a controller, which is not read; apply it to the mesh first")
                elif held.name == "instance_node":
                    name = held.reference("url")
                    if name not in self.nodes:
                        held.refuse(f"there is no node {name[:40]!r}")
                    yield from self.placed([self.nodes[name]], matrix, depth + 1)
                elif held.name == "node":
                    yield from self.placed([held], matrix, depth + 1)

    def _moved(self, instance: Element, matrix: Floats) -> Iterator[Part]:
        name = instance.reference("url")
        if name not in self.geometries:
            instance.refuse(f"there is no geometry {name[:40]!r}")
        part = self.part(name)
        if part is not None:
            self._budget.spend(len(part.points) + len(part.tail))
            with np.errstate(over="ignore", invalid="ignore"):
                moved = part.moved(matrix[:3, :3], matrix[3, :3])
            if not np.isfinite(moved.points).all():
                instance.refuse("its place makes coordinates too large")
            yield moved

    def part(self, name: str) -> Part | None:
        """The polygons of a geometry, made once."""
        if name not in self._parts:
            self._parts[name] = part_of(self.geometries[name], self.skipped)
        return self._parts[name]


def _matrix(node: Element) -> Floats:
    """The matrix of a node: its transforms, the last one nearest to the mesh."""
    made = np.eye(4)
    for element in node.children:
        if element.name in ("lookat", "skew"):
            element.refuse("this kind of transform is not read; save a matrix")
        if element.name in TRANSFORMS:
            numbers = element.numbers()
            if len(numbers) != TRANSFORMS[element.name]:
                element.refuse(f"found {len(numbers)} numbers, but {TRANSFORMS[element.name]} are required")
            with np.errstate(over="ignore", invalid="ignore"):
                made = _transform(element, numbers) @ made
    return made


def _transform(element: Element, numbers: Floats) -> Floats:
    made = np.eye(4)
    if element.name == "matrix":
        made = numbers.reshape(4, 4).T
        if (made[:, 3] != [0, 0, 0, 1]).any():
            element.refuse("the matrix is no affine map")
    elif element.name == "translate":
        made[3, :3] = numbers
    elif element.name == "scale":
        made[:3, :3] = np.diag(numbers)
    else:
        length = float(np.linalg.norm(numbers[:3]))
        if not length:
            element.refuse("the axis of the rotation has the length 0")
        made[:3, :3] = rotation(numbers[:3] / length, math.radians(numbers[3]))
    return made
