"""Fitters: coefficients that approximate samples."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl

_FAIRING = (
    "how strongly ripples are damped, 0 not at all; if not given, 1e-4 for facets, 1e-4 and then 1e-6 for smooth "
    "meshes; for least-squares 0.003 and 0.001"
)
_SMOOTHED = "how much is smoothed; if not given, what cross-validation finds"


@hookimpl
def orbiframe_components() -> list[Component]:
    """Least squares, sliding, smoothing and robust smoothing."""
    return [
        Component(
            "fitter",
            "least-squares",
            "orbiframe_fitters.least_squares:LeastSquares",
            "weighted least squares with a fairing term on the Laplacian",
            meanings={"fairing": _FAIRING},
        ),
        Component(
            "fitter",
            "sliding",
            "orbiframe_fitters.sliding:Sliding",
            "least distance along the normals: the samples slide along the surface",
            meanings={
                "fairing": _FAIRING,
                "steps": "the most steps; it stops by itself when the distance falls no more",
            },
        ),
        Component(
            "fitter",
            "smoothing",
            "orbiframe_fitters.smoothing:Smoothing",
            "splines with a penalty all over the surface, smoothed as cross-validation says",
            meanings={
                "fairing": _SMOOTHED,
                "interpolate": "true: all data are met exactly, with the least energy",
            },
        ),
        Component(
            "fitter",
            "robust",
            "orbiframe_fitters.robust:Robust",
            "smoothing splines that outliers do not pull, and that name them",
            meanings={
                "fairing": _SMOOTHED,
                "loss": "tukey, which gives far outliers no weight, or huber, which gives them little",
            },
        ),
    ]
