"""What this package adds to orbiframe; it imports nothing heavy, so that listing plugins is quick."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The basis of this package."""
    return [
        Component("basis", "hats", "orbiframe_example_hats.basis:Hats", "polynomial bumps, three times differentiable")
    ]
