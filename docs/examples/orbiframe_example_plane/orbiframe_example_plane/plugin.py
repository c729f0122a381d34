"""What this package adds to orbiframe; it imports nothing heavy, so that listing plugins is quick."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """A geometry and a group."""
    return [
        Component(
            "geometry",
            "complex-plane",
            "orbiframe_example_plane.geometry:ComplexPlane",
            "the Euclidean plane, computed with complex numbers",
        ),
        Component(
            "group",
            "rhombus",
            "orbiframe_example_plane.group:rhombus",
            "tori and Klein bottles of a rhombus of any angle",
        ),
    ]
