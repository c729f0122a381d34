"""Viewer: surfaces in a page of the browser, and in notebooks."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The commands that show a surface, and edit one."""
    return [
        Component(
            "command",
            "view",
            "orbiframe_viewer.view_command:configure",
            "look at a mesh, a saved surface or a field in the browser",
        ),
        Component(
            "command",
            "edit",
            "orbiframe_viewer.edit_command:configure",
            "drag the vertices of a mesh in the browser, and the surface follows",
        ),
    ]


@hookimpl
def orbiframe_show() -> str:
    """A page with a surface, for notebooks."""
    return "orbiframe_viewer.notebook:Shown"


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """The page of a surface."""
    return ["view double_torus.off -o out.html"]
