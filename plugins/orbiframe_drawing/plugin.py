"""Pictures of groups, tessellations and surfaces."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The picture of a group, and the command that draws a mesh on X/H."""
    return [
        Component(
            "picture",
            "group",
            "orbiframe_drawing.group_picture:draw_group",
            "the tiles of a group about its fundamental polygon",
            suffixes=(".svg", ".png", ".pdf"),
        ),
        Component(
            "command",
            "draw",
            "orbiframe_drawing.draw_command:configure",
            "draw the tessellation and the surface of a mesh",
        ),
    ]


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """A surface in space."""
    return [
        "draw double_torus.off --surface -o out.svg",
    ]
