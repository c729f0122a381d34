"""Placement: where the nodes of a glTF put their meshes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe_polygons.gltf.tree import Node

Floats = NDArray[np.float64]

IDENTITY = np.eye(4)


@dataclass(frozen=True, slots=True)
class Placed:
    """A node with a mesh, and its matrix in the world; points are rows: (x, y, z, 1) @ matrix."""

    node: Node
    mesh: int
    matrix: Floats


def placed_meshes(root: Node) -> Iterator[Placed]:
    """The nodes with meshes of the scene, from its roots down.

    Without scenes all nodes count, without nodes all meshes. Raises FormatError for a node that is met twice.
    """
    nodes, meshes = root.children("nodes"), root.children("meshes")
    if not nodes:
        yield from (Placed(mesh, k, IDENTITY) for k, mesh in enumerate(meshes))
        return
    met: set[int] = set()
    waiting = [(k, IDENTITY) for k in reversed(_roots(root, nodes))]
    while waiting:
        number, above = waiting.pop()
        node = nodes[number]
        if number in met:
            node.refuse("the node has two parents, or is a part of itself")
        met.add(number)
        matrix = local_matrix(node) @ above
        if node.has("mesh"):
            if not meshes:
                node.refuse("names a mesh, but there is none")
            yield Placed(node, node.index("mesh", most=len(meshes) - 1), matrix)
        waiting += [(k, matrix) for k in reversed(node.indices("children", len(nodes)))]


def _roots(root: Node, nodes: list[Node]) -> list[int]:
    scenes = root.children("scenes")
    if scenes:
        return scenes[root.index("scene", 0, most=len(scenes) - 1)].indices("nodes", len(nodes))
    inner = {k for node in nodes for k in node.indices("children", len(nodes))}
    return [k for k in range(len(nodes)) if k not in inner]


def local_matrix(node: Node) -> Floats:
    """The matrix of a node: given as such (column after column), or as scale, rotation and translation."""
    given = [key for key in ("translation", "rotation", "scale") if node.has(key)]
    if node.has("matrix"):
        matrix = node.numbers("matrix", [], count=16).reshape(4, 4)
        if given or (matrix[:, 3] != [0, 0, 0, 1]).any():
            node.refuse("the matrix is no affine map, or stands beside a translation, rotation or scale")
        return matrix
    x, y, z, w = _unit(node)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
            [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
            [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    made = np.eye(4)
    made[:3, :3] = node.numbers("scale", [1.0, 1.0, 1.0], count=3)[:, None] * turn
    made[3, :3] = node.numbers("translation", [0.0, 0.0, 0.0], count=3)
    return made


def _unit(node: Node) -> Floats:
    """The quaternion of the rotation, of length 1."""
    given = node.numbers("rotation", [0.0, 0.0, 0.0, 1.0], count=4)
    length = float(np.linalg.norm(given))
    if not 0.9 < length < 1.1:
        node.refuse(f"the rotation is a quaternion of length {length:g}, but 1 is required")
    return np.asarray(given / length)
