"""Bases: spaces of functions on X/H."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """Orbit sums of Gaussians."""
    return [
        Component(
            "basis",
            "gaussian",
            "orbiframe_bases.gaussian:Gaussian",
            "C-infinity Gaussians of compact support, as wide as the surface is sampled",
        ),
    ]
