"""Made: what a component gives is what its kind promises."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.registry import Registry
from orbiframe.errors import PluginError

T = TypeVar("T")


def made(registry: Registry, kind: str, name: str, found: object, wanted: type[T]) -> T:
    """What a component has given, if it is of the type of its kind. Raises PluginError otherwise."""
    if not isinstance(found, wanted):
        article = "an" if wanted.__name__[0] in "AEIOU" else "a"
        raise PluginError(
            f"{registry.title(registry.component(kind, name))} gives a {type(found).__name__}, and must give {article} "
            f"{wanted.__name__}; "
            f"`orbiframe plugins check {kind}/{name}` tries its laws"
        )
    return found


def made_coefficients(registry: Registry, name: str, found: object, shape: tuple[int, int]) -> NDArray[np.float64]:
    """The coefficients that a fitter has given, if there are so many and all are finite. Raises PluginError."""
    array = np.asarray(found)
    title = registry.title(registry.component("fitter", name))
    if array.shape != shape or array.dtype.kind != "f":
        raise PluginError(
            f"{title} gives {array.dtype} of shape {array.shape}, and must give float64 of shape {shape}; "
            f"`orbiframe plugins check fitter/{name}` tries its laws"
        )
    if not np.isfinite(array).all():
        raise PluginError(f"{title} gives coefficients that are not finite; take another fitter or basis")
    return array
