"""Attributes: the numbers at the vertices of a mesh file, read by meshio in a process of its own."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

# What belongs to the file and is no field.
_SKIPPED = {"nx", "ny", "nz", "normal", "normals", "red", "green", "blue", "alpha", "s", "t", "u", "v", "vtkghosttype"}


def columns_of(path: Path) -> dict[str, NDArray[Any]]:
    """The points "places" (n, 3), the "names" of all numbers, and these as "0", "1", …, (n,); of vectors each part."""
    import meshio

    with contextlib.redirect_stdout(io.StringIO()):
        mesh = meshio.read(path)
    found: dict[str, NDArray[np.float64]] = {}
    for name, values in mesh.point_data.items():
        numbers = np.asarray(values)
        if name.lower() in _SKIPPED or numbers.dtype.kind not in "fiu" or numbers.ndim > 2:
            continue
        parts = {name: numbers} if numbers.ndim == 1 else {f"{name} {k}": each for k, each in enumerate(numbers.T)}
        found |= {title: each.astype(np.float64) for title, each in parts.items()}
    columns = {str(k): each for k, each in enumerate(found.values())}
    return {"places": np.asarray(mesh.points, dtype=np.float64), "names": np.array(list(found), dtype="U"), **columns}
