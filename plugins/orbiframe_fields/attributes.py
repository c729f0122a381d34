"""Attributes: the numbers that a mesh file holds at its points and cells, read by meshio."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError

Array = NDArray[Any]

# What belongs to the file and not to the field.
_SKIPPED = {"nx", "ny", "nz", "normal", "normals", "vtkghosttype", "distance"}
_FLAT = ("triangle", "quad", "polygon")


def tables_of(path: Path) -> dict[str, Array]:
    """The tables "point places", "point 0", …, "cell places", "cell 0", … and the names of those with numbers.

    Places are (n, 3), points or centroids of plane cells; numbers are (n,) or (n, k). Called in a process of its own.
    """
    import meshio

    with contextlib.redirect_stdout(io.StringIO()):
        mesh = meshio.read(path)
    if mesh.points.ndim != 2 or mesh.points.shape[1] != 3:
        raise FormatError(f"{path}: its points have {mesh.points.shape[1:]} coordinates; 3 are needed")
    flat = [k for k, block in enumerate(mesh.cells) if block.type.startswith(_FLAT)]
    centroids = [mesh.points[np.asarray(face)].mean(axis=0)[None] for k in flat for face in mesh.cells[k].data]
    cells = {
        name: np.concatenate([np.asarray(found[k]) for k in flat]) for name, found in mesh.cell_data.items() if flat
    }
    made = _tables("point", mesh.points, {name: np.asarray(values) for name, values in mesh.point_data.items()})
    return made | _tables("cell", np.concatenate(centroids) if centroids else np.zeros((0, 3)), cells)


def _tables(kind: str, places: Array, found: dict[str, Array]) -> dict[str, Array]:
    kept = {
        name: values.astype(np.float64)
        for name, values in found.items()
        if values.dtype.kind in "fiub" and values.ndim <= 2 and name.lower() not in _SKIPPED
    }
    numbers = {f"{kind} {k}": values for k, values in enumerate(kept.values())}
    return {f"{kind} names": np.array(list(kept), dtype="U"), f"{kind} places": places.astype(np.float64), **numbers}
