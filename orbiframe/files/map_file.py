"""Map file: a map of a mesh to X/H on disk, without the mesh; read again it is the same to the bit."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FormatError
from orbiframe.files.array_archive import ArrayArchive
from orbiframe.files.outputs import output
from orbiframe.files.places import require_readable
from orbiframe.files.surface_laws import require_atlas, require_map
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.planes.geometry import Geometry
from orbiframe.triangulations.triangulation import Triangulation

_KIND = "orbiframe map 1"
_ATLAS = ("radius", "tail", "head", "inverse", "isometry")
_PLACES = ("patch", "points", "transition")


def save_map(triangulation: Triangulation, path: Path) -> None:
    """Write a map as a NumPy archive (.npz) without pickled objects; the file appears whole or not at all."""
    orbifold = triangulation.orbifold
    arrays: dict[str, NDArray[Any]] = {
        **{f"atlas_{name}": getattr(orbifold.atlas, name) for name in _ATLAS},
        **{name: getattr(triangulation, name) for name in _PLACES},
        "area": np.asarray(orbifold.area, dtype=np.float64),
    }
    about = {
        "kind": _KIND,
        "geometry": orbifold.geometry.name,
        "euler_characteristic": int(orbifold.euler_characteristic),
        "orientable": orbifold.orientable,
        "group": triangulation.group,
        "weights": triangulation.weights,
        "sha256": _sum(arrays),
    }
    with output(path) as made, made.open("wb") as file:
        np.savez(file, **{"about": np.array(json.dumps(about)), **arrays})  # type: ignore[arg-type]


def load_map(path: Path, polyhedron: Polyhedron, geometry: Geometry) -> Triangulation:
    """The map of a file that `save_map` wrote, of the triangle mesh that was mapped.

    The laws of atlases and maps are checked. Raises FormatError for any other file or mesh.
    """
    require_readable(path)
    try:
        with ArrayArchive(path) as archive:
            about = json.loads(str(archive.read("about")))
            arrays = {name: archive.read(name) for name in archive.shapes if name != "about"}
        if about["kind"] != _KIND or about["geometry"] != geometry.name or about["sha256"] != _sum(arrays):
            raise ValueError("it is not what was saved")
        orbifold = Orbifold(
            require_atlas(arrays, geometry),
            about["euler_characteristic"],
            about["orientable"],
            float(arrays["area"]),
        )
        patch, points, transition = (arrays[name] for name in _PLACES)
        found = Triangulation(orbifold, polyhedron, patch, points, transition, about["group"], about["weights"])
        require_map(found)
    except FormatError:
        raise
    except Exception as error:
        raise FormatError(f"{path}: this is no whole map of the mesh ({error}); it can be deleted") from error
    return found


def _sum(arrays: dict[str, NDArray[Any]]) -> str:
    found = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        found.update(f"{name} {array.dtype.str} {array.shape};".encode())
        found.update(array.tobytes())
    return found.hexdigest()
