"""Surfaces for JAX: points with gradients by the coefficients and by the parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from orbiframe.errors import UsageError
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.pullback import pulled_back, require_slopes, surface_values
from orbiframe.surfaces.surface import OrbifoldSurface


def jax_surface(surface: OrbifoldSurface) -> Callable[[Any, Points], Any]:
    """The surface as a function of JAX: (coefficients, points) to points in space (n, 3), for `jax.grad` and `jit`.

    coefficients: (size, 3); points: of X/H, whose `x` (n, 3) may be traced, and whose patches are numbers that are
    known. What is meant is the point x / rho(x) of X, so that any x near X will do, and the gradient by x is a covector
    of R^3 that vanishes along x. To all digits with `jax.config.update("jax_enable_x64", True)`. Derivatives of
    gradients are not known. Raises UsageError without JAX (`pip install orbiframe[jax]`), FitError for functions
    without derivatives.
    """
    try:
        import jax
    except ImportError as error:
        raise UsageError("gradients for JAX need it: run `pip install 'orbiframe[jax]'`") from error
    require_slopes(surface)

    def double(*arrays: Any) -> list[Any]:
        return [np.asarray(array, dtype=np.float64) for array in arrays]

    def on_host(patch: Any, coefficients: Any, x: Any) -> Any:
        c, y = double(coefficients, x)
        return surface_values(surface, c, patch, y).astype(coefficients.dtype)

    def back_on_host(patch: Any, coefficients: Any, x: Any, slopes: Any) -> Any:
        c, y, s = double(coefficients, x, slopes)
        by_coefficients, by_x = pulled_back(surface, c, patch, y, s)
        return by_coefficients.astype(coefficients.dtype), by_x.astype(x.dtype)

    def evaluate(coefficients: Any, points: Points) -> Any:
        patch = np.asarray(points.patch, dtype=np.intp)

        @jax.custom_vjp
        def values(c: Any, x: Any) -> Any:
            shape = jax.ShapeDtypeStruct((x.shape[0], c.shape[1]), c.dtype)
            return jax.pure_callback(lambda *a: on_host(patch, *a), shape, c, x)

        def forward(c: Any, x: Any) -> Any:
            return values(c, x), (c, x)

        def backward(kept: Any, slopes: Any) -> Any:
            shapes = tuple(jax.ShapeDtypeStruct(part.shape, part.dtype) for part in kept)
            return jax.pure_callback(lambda *a: back_on_host(patch, *a), shapes, *kept, slopes)

        values.defvjp(forward, backward)
        return values(jax.numpy.asarray(coefficients), jax.numpy.asarray(points.x))

    return evaluate
