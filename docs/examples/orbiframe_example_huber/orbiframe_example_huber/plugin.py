"""What this package adds to orbiframe; it imports nothing heavy, so that listing plugins is quick."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The fitter of this package."""
    return [
        Component("fitter", "huber", "orbiframe_example_huber.fitter:Huber", "least squares that outliers do not pull")
    ]
