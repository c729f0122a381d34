"""Fitters: coefficients that approximate samples."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """Weighted least squares."""
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
    ]
