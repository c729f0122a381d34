"""Fields on surfaces: curvature of meshes."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The command that measures curvature."""
    return [
        Component(
            "command",
            "curvature",
            "orbiframe_fields.curvature_command:configure",
            "principal curvatures and directions at the vertices of a mesh",
        ),
    ]


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """Curvature of a surface of the functions that the command takes."""
    return [
        "curvature torus.off -o curvature.csv",
    ]
