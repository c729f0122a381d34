"""Nodes: curved triangles as text, a line for each node and each element."""

from __future__ import annotations

from pathlib import Path

from orbiframe.plugin import Component, hookimpl
from orbiframe.surfaces import CurvedMesh


@hookimpl
def orbiframe_components() -> list[Component]:
    """The format of this file."""
    return [Component("elements", "nodes", "nodes:write", "nodes and elements as lines of text", suffixes=(".nodes",))]


def write(path: Path, mesh: CurvedMesh) -> None:
    """A header with the order and the numbers of nodes and elements, the nodes with all digits, the elements."""
    lines = [f"{mesh.order} {len(mesh.nodes)} {len(mesh.elements)}"]
    lines += [" ".join(map(repr, node)) for node in mesh.nodes.tolist()]
    lines += [" ".join(map(str, element)) for element in mesh.elements.tolist()]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
