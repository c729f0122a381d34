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
        Component(
            "basis",
            "ps3",
            "orbiframe_bases.powell_sabin:PowellSabin3",
            "C1 cubic Powell-Sabin splines, C2 across the edges of the triangulation",
        ),
        Component("basis", "ps4", "orbiframe_bases.powell_sabin:PowellSabin4", "C1 quartic Powell-Sabin splines"),
        Component("basis", "ps5", "orbiframe_bases.powell_sabin:PowellSabin5", "C2 quintic Powell-Sabin splines"),
        Component("basis", "ps6", "orbiframe_bases.powell_sabin:PowellSabin6", "C2 Powell-Sabin splines of degree 6"),
        Component(
            "basis",
            "tensor-bspline",
            "orbiframe_bases.tensor_bspline:TensorBSpline",
            "products of periodic B-splines of any degree and knots on a torus or Klein bottle",
        ),
        Component(
            "basis",
            "dms",
            "orbiframe_bases.dms:DMS",
            "simplex splines over clouds of knots, as smooth as wanted: C2 cubics, C3 quartics",
        ),
    ]
