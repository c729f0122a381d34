"""Surfaces for PyTorch: points with gradients by the coefficients and by the parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from orbiframe.errors import UsageError
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.pullback import pulled_back, require_slopes, surface_values
from orbiframe.surfaces.surface import OrbifoldSurface


def torch_surface(surface: OrbifoldSurface) -> Callable[[Any, Points], Any]:
    """The surface as a function of PyTorch: (coefficients, points) to points in space (n, 3).

    coefficients: a tensor (size, 3), such as `torch.tensor(surface.coefficients, requires_grad=True)`; points: of X/H,
    whose `x` (n, 3) may be a tensor with a gradient too. What is meant is the point x / rho(x) of X, so that any x near
    X will do, and the gradient by x is a covector of R^3 that vanishes along x: after a step along it, points need no
    correction. All in double precision on the processor. Derivatives of gradients are not known. Raises
    UsageError without PyTorch (`pip install orbiframe[torch]`), FitError for functions without derivatives.
    """
    try:
        import torch
    except ImportError as error:
        raise UsageError("gradients for PyTorch need it: run `pip install 'orbiframe[torch]'`") from error
    require_slopes(surface)

    class Evaluation(torch.autograd.Function):  # type: ignore[misc]
        @staticmethod
        def forward(ctx: Any, coefficients: Any, x: Any, patch: Any) -> Any:
            ctx.save_for_backward(coefficients, x)
            ctx.patch = patch
            return torch.from_numpy(surface_values(surface, coefficients.numpy(), patch, x.numpy()))

        @staticmethod
        @torch.autograd.function.once_differentiable
        def backward(ctx: Any, slopes: Any) -> Any:
            coefficients, x = ctx.saved_tensors
            found = pulled_back(surface, coefficients.numpy(), ctx.patch, x.numpy(), slopes.numpy())
            return *(torch.from_numpy(part) for part in found), None

    def evaluate(coefficients: Any, points: Points) -> Any:
        x = torch.as_tensor(points.x, dtype=torch.float64)
        return Evaluation.apply(coefficients, x, np.asarray(points.patch, dtype=np.intp))

    return evaluate
