"""Remeshing: even triangles and quadrilaterals on the smooth surface."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The command that meshes a smooth surface anew."""
    return [
        Component(
            "command",
            "remesh",
            "orbiframe_remeshing.remesh_command:configure",
            "make a mesh of even triangles or quadrilaterals on the smooth surface",
        )
    ]
