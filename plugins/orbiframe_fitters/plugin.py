"""Fitters: coefficients that approximate samples."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """Least squares, sliding and smoothing."""
    return [
        Component(
            "fitter",
            "least-squares",
            "orbiframe_fitters.least_squares:LeastSquares",
            "weighted least squares with a fairing term on the Laplacian",
        ),
        Component(
            "fitter",
            "sliding",
            "orbiframe_fitters.sliding:Sliding",
            "least distance along the normals: the samples slide along the surface",
        ),
        Component(
            "fitter",
            "smoothing",
            "orbiframe_fitters.smoothing:Smoothing",
            "splines with a penalty all over the surface, smoothed as cross-validation says",
        ),
    ]
