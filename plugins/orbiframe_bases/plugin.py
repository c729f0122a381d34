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
        Component(
            "basis",
            "simplex",
            "orbiframe_bases.simplex:Simplex",
            "B-splines of the vertices of a triangulation: C1 quadratics, C2 cubics, not negative, few functions",
        ),
        Component(
            "basis",
            "clough-tocher",
            "orbiframe_bases.clough_tocher:CloughTocher",
            "C1 cubics on triangles split in three: gradients at vertices, slopes across edges",
        ),
        Component(
            "basis",
            "argyris",
            "orbiframe_bases.argyris:Argyris",
            "C1 polynomials of degree 5 or more on whole triangles",
        ),
        Component(
            "basis",
            "zenisek",
            "orbiframe_bases.argyris:Zenisek",
            "C2 polynomials of degree 9 or more on whole triangles: most digits a function",
        ),
        Component(
            "basis",
            "hybrid",
            "orbiframe_bases.hybrid:Hybrid",
            "C1 rational blends of cubics on whole triangles (Liu and Schumaker)",
        ),
        Component(
            "basis",
            "wendland",
            "orbiframe_bases.wendland:Wendland",
            "polynomials of compact support with 2, 4 or 6 derivatives, as wide as the surface is sampled",
        ),
    ]


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """Each compiled way to evaluate; the other bases share these."""
    return [
        "fit double_torus.off -o out.ply --quiet --basis ps2",
        "fit prism.off -o out.ply --quiet --basis ps2",
        "fit torus.off -o out.ply --quiet --basis ps2",
        "fit double_torus.off -o out.ply --quiet --basis bernstein",
        "fit double_torus.off -o out.ply --quiet --basis simplex",
        "fit double_torus.off -o out.ply --quiet --basis dms",
        "fit torus.off -o out.ply --quiet --basis tensor-bspline",
    ]
