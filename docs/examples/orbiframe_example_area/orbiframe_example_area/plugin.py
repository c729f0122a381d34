"""What this package adds to orbiframe; it imports nothing heavy, so that listing plugins is quick."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The command of this package."""
    return [
        Component("command", "area", "orbiframe_example_area.command:configure", "area and curvature of a smooth mesh")
    ]
