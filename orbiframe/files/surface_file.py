"""Surface file: a smooth surface saved whole, so that it evaluates to the same bits when loaded."""

from __future__ import annotations

import json
import os
import zipfile
import zlib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.options import checked_options
from orbiframe.errors import FormatError
from orbiframe.files.gate import Components
from orbiframe.files.places import require_readable
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.flat_flips import FlatFlips
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.orbifolds.atlas import Atlas
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.triangulations.triangulation import Triangulation

Arrays = Mapping[str, NDArray[Any]]

_KIND, _VERSION = "orbiframe surface", 2  # version 1 knows no flips
# What numpy, zipfile and json raise where bytes are not those that were written; zipfile raises RuntimeError too.
_DAMAGE = (ValueError, LookupError, TypeError, OSError, EOFError, RuntimeError, zipfile.BadZipFile, zlib.error)
_MESH = ("vertices", "offsets", "tail", "twin", "same")


def save_surface(surface: OrbifoldSurface, path: Path) -> None:
    """Write a surface as a NumPy archive (.npz) without pickled objects; the file appears whole or not at all.

    It holds the mesh, the map, the coefficients, and the name and options of the basis, which is built anew from them
    when loaded: the same input gives the same basis. Raises FormatError where the file cannot be written.
    """
    path = Path(path)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with unfinished.open("wb") as file:
            np.savez_compressed(file, **_arrays(surface))
        unfinished.replace(path)
    except OSError as error:
        raise FormatError(f"{path}: the surface cannot be written: {error.strerror}") from error
    finally:
        with suppress(OSError):
            unfinished.unlink()


def load_surface(path: Path, registry: Components) -> OrbifoldSurface:
    """The surface of a file that `save_surface` wrote; evaluates to the same bits with the same versions.

    Raises FormatError, naming the file, for any other file; UsageError or PluginError where the geometry or the basis
    is not installed or takes other options now.
    """
    path = Path(path)
    require_readable(path)
    try:
        with np.load(path, allow_pickle=False) as archive:
            if damaged := archive.zip.testzip():
                raise ValueError(f"{damaged} is damaged")
            arrays = {name: archive[name] for name in archive.files}
        about = json.loads(str(arrays["about"]))
        if about["kind"] != _KIND or about["version"] not in range(1, _VERSION + 1):
            raise FormatError(
                f"{path}: version {about['version']} of '{about['kind']}' is not known; 1 to {_VERSION} are"
            )
        triangulation = _triangulation(arrays, about, registry)
        coarse = _polyhedron(arrays, "coarse")
        flips = _flips(arrays, coarse)
        refinement = Bisection(coarse, triangulation.polyhedron, arrays["side"], arrays["child"], flips)
        coefficients, origin, scale = arrays["coefficients"], arrays["origin"], float(arrays["scale"])
        name, options = about["basis"], dict(about["options"])
    except _DAMAGE as error:
        raise FormatError(
            f"{path}: this is not a whole surface file ({type(error).__name__}: {error}); make it with "
            "`orbiframe fit MESH -o OUT --save FILE`"
        ) from error
    make = registry.load("basis", name)
    basis: Any = make(triangulation.orbifold, triangulation, **checked_options(make, options, "basis", {}))
    if basis.size != len(coefficients):
        raise FormatError(
            f"{path}: the file has {len(coefficients)} coefficients and the installed basis '{name}' {basis.size} "
            "functions; install the version of its plugin that made the file, or fit the mesh again"
        )
    return OrbifoldSurface(triangulation, refinement, basis, coefficients, origin, scale, name, options)


def _arrays(surface: OrbifoldSurface) -> dict[str, Any]:
    triangulation, orbifold = surface.triangulation, surface.orbifold
    atlas = orbifold.atlas
    about = {
        "kind": _KIND,
        "version": _VERSION,
        "geometry": orbifold.geometry.name,
        "euler_characteristic": orbifold.euler_characteristic,
        "orientable": orbifold.orientable,
        "group": triangulation.group,
        "weights": triangulation.weights,
        "basis": surface.basis_name,
        "options": dict(surface.basis_options),
    }
    flips = surface.refinement.flips
    return {
        **({} if flips is None else {"flip_halfedge": flips.halfedge, "flip_crossing": flips.crossing}),
        "about": np.array(json.dumps(about, sort_keys=True)),
        **{f"coarse_{name}": getattr(surface.refinement.coarse, name) for name in _MESH},
        **{f"fine_{name}": getattr(triangulation.polyhedron, name) for name in _MESH},
        **{f"atlas_{name}": getattr(atlas, name) for name in ("radius", "tail", "head", "inverse", "isometry")},
        "side": surface.refinement.side,
        "child": surface.refinement.child,
        "patch": triangulation.patch,
        "points": triangulation.points,
        "transition": triangulation.transition,
        "area": np.array(orbifold.area),
        "coefficients": surface.coefficients,
        "origin": surface.origin,
        "scale": np.array(surface.scale),
    }


def _triangulation(arrays: Arrays, about: Mapping[str, Any], registry: Components) -> Triangulation:
    geometry: Any = registry.load("geometry", about["geometry"])()
    atlas = Atlas(geometry, *(arrays[f"atlas_{name}"] for name in ("radius", "tail", "head", "inverse", "isometry")))
    orbifold = Orbifold(atlas, about["euler_characteristic"], about["orientable"], float(arrays["area"]))
    return Triangulation(
        orbifold,
        _polyhedron(arrays, "fine"),
        arrays["patch"],
        arrays["points"],
        arrays["transition"],
        about["group"],
        about["weights"],
    )


def _flips(arrays: Arrays, coarse: Polyhedron) -> FlatFlips | None:
    if "flip_halfedge" not in arrays:
        return None
    halfedge, crossing = arrays["flip_halfedge"], arrays["flip_crossing"]
    known = halfedge.size == 0 or 0 <= halfedge.min() <= halfedge.max() < len(coarse.tail)
    if not (known and halfedge.shape == crossing.shape == (len(halfedge), 2)):
        raise ValueError("flips of edges that the mesh does not have")
    return FlatFlips(coarse, halfedge.astype(np.intp), crossing.astype(np.float64))


def _polyhedron(arrays: Arrays, prefix: str) -> Polyhedron:
    return Polyhedron(*(arrays[f"{prefix}_{name}"] for name in _MESH))
