"""Bases: spaces of functions on X/H."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """Orbit sums of Gaussians, and piecewise polynomials on geodesic triangles."""
    return [
        Component(
            "basis",
            "gaussian",
            "orbiframe_bases.gaussian:Gaussian",
            "C-infinity Gaussians of compact support, as wide as the surface is sampled",
        ),
        Component(
            "basis",
            "bernstein",
            "orbiframe_bases.bernstein:Bernstein",
            "continuous polynomials of any degree on geodesic triangles",
        ),
        Component(
            "basis",
            "ps2",
            "orbiframe_bases.powell_sabin:PowellSabin2",
            "C1 quadratic Powell-Sabin splines, not negative, three control points a vertex",
        ),
    ]
