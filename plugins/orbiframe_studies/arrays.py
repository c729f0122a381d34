"""Arrays: the numbers of a fit in an HDF5 file, a group for each component of the mesh."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError, PluginError
from orbiframe.files import output
from orbiframe.fitting import Parts


class SurfaceArrays(NamedTuple):
    """Arrays of one surface: coefficients (N, 3); vertices (V, 3) and triangles (F, 3) of a mesh on it."""

    coefficients: NDArray[np.float64]
    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]


def require_arrays() -> Any:
    """The library for HDF5. Raises PluginError where it is not installed."""
    try:
        import h5py
    except ImportError as error:
        raise PluginError('arrays are kept as HDF5, which needs h5py: pip install "orbiframe[studies]"') from error
    return h5py


def write_arrays(path: Path, parts: Parts) -> None:
    """Write the arrays of all surfaces; the file appears whole or not at all."""
    h5py = require_arrays()
    with output(path) as made, h5py.File(made, "w", track_order=False) as file:
        for number, result in enumerate(parts.results, start=1):
            surface, mesh = result.surface, result.output
            group = file.create_group(f"part{number}")
            arrays = {
                "coefficients": surface.coefficients,
                "origin": surface.origin,
                "vertices": mesh.vertices,
                "triangles": mesh.triangles,
                "normals": mesh.normals,
            }
            for name, array in arrays.items():
                if array is not None:
                    # Without times of creation, so that equal fits give equal bytes.
                    packed = {"compression": "gzip", "shuffle": True} if np.ndim(array) > 1 else {}
                    group.create_dataset(name, data=array, track_times=False, **packed)
            group.attrs["scale"] = surface.scale
            group.attrs["basis"] = surface.basis_name
            group.attrs["options"] = json.dumps(dict(surface.basis_options), default=str, sort_keys=True)


def read_arrays(path: Path) -> list[SurfaceArrays]:
    """The arrays of a file that `write_arrays` wrote. Raises FormatError for any other."""
    h5py = require_arrays()
    try:
        with h5py.File(path, "r") as file:
            groups = [file[f"part{number}"] for number in range(1, len(file) + 1)]
            return [SurfaceArrays(*(group[name][()] for name in SurfaceArrays._fields)) for group in groups]
    except (OSError, KeyError, ValueError) as error:
        raise FormatError(f"{path}: these are no arrays of a fit ({error}); run the study again") from error
