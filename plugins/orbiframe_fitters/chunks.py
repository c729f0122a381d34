"""Chunks: samples part by part, so that few derivatives are in memory at one time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from orbiframe import Samples
from orbiframe.meshes import curve_order

_CHUNK = 1 << 14  # samples in a part


def chunks(samples: Samples) -> Iterator[tuple[Samples, NDArray[np.intp]]]:
    """The samples patch by patch and near ones together: they share lifts, and places of the matrix in the cache."""
    order = curve_order(samples.points.x)
    order = order[np.argsort(samples.points.patch[order], kind="stable")]
    for begin in range(0, len(order), _CHUNK):
        chosen = order[begin : begin + _CHUNK]
        yield samples.take(chosen), chosen
