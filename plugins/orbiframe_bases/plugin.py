"""Bases: spaces of functions on X/H."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl

_SIZE = {"size": "how many functions; if not given, `fit` takes as many as the shape needs, at least 1000"}
_GRADING = "how much of the density of the functions follows the girth of the surface; the rest is even"


@hookimpl
def orbiframe_components() -> list[Component]:
    """Orbit sums of Gaussians, and piecewise polynomials on geodesic triangles."""
    return [
        Component(
            "basis",
            "gaussian",
            "orbiframe_bases.gaussian:Gaussian",
            "C-infinity Gaussians of compact support, as wide as the surface is sampled",
            meanings={
                **_SIZE,
                "width": "width of a Gaussian, relative to the distance between neighbouring centres",
                "reach": "radius of its support, in widths",
                "grading": _GRADING,
            },
        ),
        Component(
            "basis",
            "bernstein",
            "orbiframe_bases.bernstein:Bernstein",
            "continuous polynomials of any degree on geodesic triangles",
            meanings={**_SIZE, "degree": "1 to 15"},
        ),
        Component(
            "basis",
            "ps2",
            "orbiframe_bases.powell_sabin:PowellSabin2",
            "C1 quadratic Powell-Sabin splines, not negative, three control points a vertex",
            meanings=_SIZE,
        ),
        Component(
            "basis",
            "ps3",
            "orbiframe_bases.powell_sabin:PowellSabin3",
            "C1 cubic Powell-Sabin splines, C2 across the edges of the triangulation",
            meanings=_SIZE,
        ),
        Component(
            "basis",
            "ps4",
            "orbiframe_bases.powell_sabin:PowellSabin4",
            "C1 quartic Powell-Sabin splines",
            meanings=_SIZE,
        ),
        Component(
            "basis",
            "ps5",
            "orbiframe_bases.powell_sabin:PowellSabin5",
            "C2 quintic Powell-Sabin splines",
            meanings=_SIZE,
        ),
        Component(
            "basis",
            "ps6",
            "orbiframe_bases.powell_sabin:PowellSabin6",
            "C2 Powell-Sabin splines of degree 6",
            meanings=_SIZE,
        ),
        Component(
            "basis",
            "tensor-bspline",
            "orbiframe_bases.tensor_bspline:TensorBSpline",
            "products of periodic B-splines of any degree and knots on a torus or Klein bottle",
            meanings={
                **_SIZE,
                "degree": "1 to 15",
                "counts": "numbers of functions in the two directions, such as [40, 12], in place of size",
                "knots_u": "knots of one period in the first direction, rising from 0 to below 1; None: uniform ones",
                "knots_v": "the same for the second direction; on a Klein bottle symmetric under v → −v",
            },
        ),
        Component(
            "basis",
            "dms",
            "orbiframe_bases.dms:DMS",
            "simplex splines over clouds of knots, as smooth as wanted: C2 cubics, C3 quartics",
            meanings={
                **_SIZE,
                "degree": "1 to 10; the functions are C^(degree − 1)",
                "condensed": "functions with the same blossom arguments are added: fewer functions, better condition",
                "radius": "radius of the clouds of knots, in shortest edges at the vertex, up to 0.3",
            },
        ),
        Component(
            "basis",
            "simplex",
            "orbiframe_bases.simplex:Simplex",
            "B-splines of the vertices of a triangulation: C1 quadratics, C2 cubics, not negative, few functions",
            meanings={
                **_SIZE,
                "degree": "1, 2 or 3; the functions are C^(degree − 1)",
                "radius": "how far knots are moved from their vertices, in shortest edges, from 0 to 0.3",
            },
        ),
        Component(
            "basis",
            "clough-tocher",
            "orbiframe_bases.clough_tocher:CloughTocher",
            "C1 cubics on triangles split in three: gradients at vertices, slopes across edges",
            meanings=_SIZE,
        ),
        Component(
            "basis",
            "argyris",
            "orbiframe_bases.argyris:Argyris",
            "C1 polynomials of degree 5 or more on whole triangles",
            meanings={**_SIZE, "degree": "5 or more; odd degrees are divided by W on S² and H²"},
        ),
        Component(
            "basis",
            "zenisek",
            "orbiframe_bases.argyris:Zenisek",
            "C2 polynomials of degree 9 or more on whole triangles: most digits a function",
            meanings={**_SIZE, "degree": "9 to 15"},
        ),
        Component(
            "basis",
            "hybrid",
            "orbiframe_bases.hybrid:Hybrid",
            "C1 rational blends of cubics on whole triangles (Liu and Schumaker)",
            meanings=_SIZE,
        ),
        Component(
            "basis",
            "wendland",
            "orbiframe_bases.wendland:Wendland",
            "polynomials of compact support with 2, 4 or 6 derivatives, as wide as the surface is sampled",
            meanings={
                **_SIZE,
                "derivatives": "continuous derivatives: 2, 4 or 6",
                "reach": "radius of the support, relative to the distance between neighbouring centres",
                "grading": _GRADING,
            },
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
