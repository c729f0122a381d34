"""What this package adds to orbiframe; it imports nothing heavy, so that listing plugins is quick."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The exporter of this package."""
    return [
        Component(
            "exporter",
            "bezier-json",
            "orbiframe_example_bezier.exporter:export",
            "control points and weights of the exact patches, as JSON",
            suffixes=(".bezier",),
        )
    ]
