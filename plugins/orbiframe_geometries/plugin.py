"""The three planes of constant curvature."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The sphere, the Euclidean plane and the hyperbolic plane."""
    return [
        Component("geometry", "s2", "orbiframe_geometries.s2:S2", "the unit sphere, curvature +1"),
        Component("geometry", "e2", "orbiframe_geometries.e2:E2", "the Euclidean plane, curvature 0"),
        Component("geometry", "h2", "orbiframe_geometries.h2:H2", "the hyperbolic plane, curvature -1"),
    ]
