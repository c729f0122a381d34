"""Surface file: a smooth surface saved whole, so that it evaluates to the same bits when loaded."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.geometry_names import geometry_name
from orbiframe.components.options import checked_options
from orbiframe.components.registry import Registry
from orbiframe.errors import FormatError, OrbiframeError
from orbiframe.files.array_archive import ArrayArchive, Shape
from orbiframe.files.gate import Components
from orbiframe.files.outputs import output
from orbiframe.files.places import require_readable
from orbiframe.files.surface_laws import (
    BrokenLaw,
    require,
    require_atlas,
    require_creases,
    require_inside,
    require_map,
    require_mesh,
    require_refinement,
)
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.polyhedron import UNITS
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.triangulations.triangulation import Triangulation

Arrays = Mapping[str, NDArray[Any]]
About = dict[str, Any]
T = TypeVar("T")

_KIND, _VERSION = "orbiframe surface", 2
# Files of version 1 have no check sums.
_KNOWN = (1, 2)
_LONGEST_TEXT = 2**16
_MESH = ("vertices", "offsets", "tail", "twin", "same")
_ATLAS = ("radius", "tail", "head", "inverse", "isometry")
_WORDS = {
    "geometry": str,
    "euler_characteristic": int,
    "orientable": bool,
    "group": str,
    "weights": str,
    "basis": str,
    "options": dict,
}
# The type of every array and its shape, where a letter is a length that all arrays with it share.
_SHAPES: dict[str, tuple[type, tuple[int | str, ...]]] = {
    **{
        f"{mesh}_{name}": (kind, shape)
        for mesh, v, f, h in (("coarse", "V", "F", "H"), ("fine", "W", "G", "I"))
        for name, kind, shape in (
            ("vertices", np.float64, (v, 3)),
            ("offsets", np.intp, (f,)),
            ("tail", np.intp, (h,)),
            ("twin", np.intp, (h,)),
            ("same", np.bool_, (h,)),
        )
    },
    "atlas_radius": (np.float64, ("P",)),
    "atlas_tail": (np.intp, ("T",)),
    "atlas_head": (np.intp, ("T",)),
    "atlas_inverse": (np.intp, ("T",)),
    "atlas_isometry": (np.float64, ("T", 3, 3)),
    "side": (np.intp, ("N",)),
    "child": (np.intp, ("N",)),
    "patch": (np.intp, ("W",)),
    "points": (np.float64, ("W", 3)),
    "transition": (np.intp, ("I",)),
    "area": (np.float64, ()),
    "coefficients": (np.float64, ("B", 3)),
    "origin": (np.float64, (3,)),
    "scale": (np.float64, ()),
}
# Arrays that some surfaces have.
_OPTIONAL: dict[str, tuple[type, tuple[int | str, ...]]] = {
    "density": (np.float64, ("W",)),
    "crease": (np.bool_, ("I",)),
    "sites": (np.intp, ("S",)),
    "seam": (np.bool_, ("I",)),
    "inside": (np.bool_, ("G1",)),
    "flip_halfedge": (np.intp, ("L", 2)),
    "flip_crossing": (np.float64, ("L", 2)),
    "flip_halved": (np.bool_, ("L",)),
}
_KINDS = _SHAPES | _OPTIONAL


def save_surface(surface: OrbifoldSurface, path: Path) -> None:
    """Write a surface as a NumPy archive (.npz) without pickled objects; the file appears whole or not at all.

    It holds the mesh, the map, the coefficients, and the name and options of the basis, which is built anew from them
    when loaded: the same input gives the same basis. A check sum of each array goes with them. Raises FormatError where
    the file cannot be written.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from orbiframe import fit, load_surface, save_surface
    >>> surface = fit("dataset:torus", size=60).surface
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_surface(surface, Path(folder) / "torus.npz")
    ...     again = load_surface(Path(folder) / "torus.npz")
    >>> points = surface.points([3], [[0.2, 0.3, 0.5]])
    >>> bool((again.evaluate(points) == surface.evaluate(points)).all())
    True
    """
    arrays = _arrays(surface)
    about = _about(surface)
    sums = {name: _sum_of(array) for name, array in arrays.items()}
    text = json.dumps(about | {"sha256": sums | {"about": _sum_of_words(about)}}, sort_keys=True)
    with output(Path(path)) as made, made.open("wb") as file:
        np.savez_compressed(file, **{"about": np.array(text), **arrays})  # type: ignore[arg-type]


def load_surface(path: str | Path, registry: Components | None = None) -> OrbifoldSurface:
    """The surface of a file that `save_surface` wrote; evaluates to the same bits with the same versions.

    registry: by default all that is installed.

    Everything that later steps rely on is checked before anything is computed: shapes and types before memory is
    taken, then the laws of meshes, refinements, atlases and maps (see `surface_laws`), then the check sums. Raises
    FormatError, naming the file, the array and the law, for any file with other content; UsageError or PluginError
    where the geometry or the basis is not installed or takes other options now.
    """
    path = Path(path)
    registry = Registry.discover() if registry is None else registry
    return _of_file(path, lambda arrays, about: _surface(arrays, about, registry, path))


class SurfaceMap(NamedTuple):
    """The map of a saved surface: of a refined mesh of unit size, and where and how large that mesh is in space.

    size: the number of functions that it was made for, as far as they have an option of that name.
    """

    triangulation: Triangulation
    refinement: Bisection
    origin: NDArray[np.float64]
    scale: float
    size: int | None


def load_surface_map(path: Path, registry: Components) -> SurfaceMap:
    """The map of a file that `save_surface` wrote, without the functions on it. Raises what `load_surface` raises."""
    return _of_file(path, lambda arrays, about: _map(arrays, about, registry))


def _of_file(path: Path, made: Callable[[Arrays, About], T]) -> T:
    """What is made of the content of a file; a broken law is told with the name of the file."""
    require_readable(path)
    try:
        return made(*_read(path))
    except BrokenLaw as error:
        raise FormatError(f"{path}: {error}; the file was changed or damaged: save the surface again") from error


# ---- reading ------------------------------------------------------------------------------------------------------


def _read(path: Path) -> tuple[Arrays, About]:
    """All arrays, and what the file says of itself; whatever the parsers of archives and texts raise is a sentence."""
    try:
        with ArrayArchive(path) as archive:
            about = _read_about(archive, path)
            _require_shapes(archive.shapes)
            return {name: archive.read(name) for name in _KINDS if name in archive.shapes}, about
    except (BrokenLaw, FormatError):
        raise
    except Exception as error:
        raise FormatError(
            f"{path}: this is not a whole surface file ({type(error).__name__}: {error}); make it with "
            "`orbiframe fit MESH -o OUT --save FILE`"
        ) from error


def _read_about(archive: ArrayArchive, path: Path) -> About:
    """What the file says of itself; its version is known and every entry of its type."""
    shape = archive.shapes["about"]
    if shape.type.kind != "U" or shape.shape != () or shape.size > _LONGEST_TEXT:
        raise ValueError("the array 'about' is no short text")
    about = json.loads(str(archive.read("about")), object_pairs_hook=_without_doubles, parse_constant=_no_number)
    kind, version = about["kind"], about["version"]
    if kind != _KIND or isinstance(version, bool) or version not in _KNOWN:
        raise FormatError(f"{path}: version {version} of '{kind}' is not known; versions 1 and 2 are")
    for name, type_ in _WORDS.items():
        if not isinstance(about[name], type_) or (isinstance(about[name], bool) and type_ is not bool):
            raise TypeError(f"'{name}' in the array 'about' is no {type_.__name__}")
    if about.get("unit") not in (None, *UNITS):
        raise ValueError(f"'unit' in the array 'about' is none of {', '.join(UNITS)}")
    return dict(about)


def _without_doubles(pairs: list[tuple[str, Any]]) -> About:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("the array 'about' has an entry twice")
    return found


def _no_number(name: str) -> float:
    raise ValueError(f"the array 'about' has the entry {name}")


def _require_shapes(shapes: Mapping[str, Shape]) -> None:
    """Raise BrokenLaw unless all arrays are there, of their types and of shapes that fit together."""
    lengths: dict[str, tuple[int, str]] = {}
    for name, (type_, asked) in _KINDS.items():
        if name in _OPTIONAL and name not in shapes:
            continue
        found = shapes[name]
        if found.type.newbyteorder("=") != np.dtype(type_):
            raise BrokenLaw(name, f"its numbers are {np.dtype(type_).name}, not {found.type.name}")
        if len(found.shape) != len(asked):
            raise BrokenLaw(name, f"it has {len(asked)} axes, not {len(found.shape)}")
        for length, wanted in zip(found.shape, asked, strict=True):
            known, owner = lengths.setdefault(wanted, (length, name)) if isinstance(wanted, str) else (wanted, "")
            if length != known:
                like = f", as in '{owner}'" if owner else ""
                raise BrokenLaw(name, f"it is {found.shape}, but {known} is required{like}")
    if extra := set(shapes) - set(_KINDS) - {"about"}:
        raise BrokenLaw(min(extra), "surface files have no such array")


def _surface(arrays: Arrays, about: About, registry: Components, path: Path) -> OrbifoldSurface:
    make = registry.load("basis", about["basis"])
    options = checked_options(make, about["options"], "basis", {})
    found, coefficients = _map(arrays, about, registry), arrays["coefficients"]
    basis = _basis(make, about["basis"], found.triangulation, options, path)
    if basis.size != len(coefficients):
        raise FormatError(
            f"{path}: the file has {len(coefficients)} coefficients and the installed basis '{about['basis']}' "
            f"{basis.size} functions; install the version of its plugin that made the file, or fit the mesh again"
        )
    return OrbifoldSurface(
        found.triangulation,
        found.refinement,
        basis,
        coefficients,
        found.origin,
        found.scale,
        about["basis"],
        about["options"],
    )


def _map(arrays: Arrays, about: About, registry: Components) -> SurfaceMap:
    geometry: Any = registry.load("geometry", about["geometry"])()
    chi = about["euler_characteristic"]
    sign = (chi > 0) - (chi < 0)
    require(
        geometry.curvature == sign, "about", f"a surface of Euler characteristic {chi} is made of {geometry_name(chi)}"
    )
    coarse, fine = (require_mesh(arrays, prefix, about) for prefix in ("coarse", "fine"))
    coarse = replace(coarse, unit=about.get("unit"))
    refinement = require_refinement(arrays, coarse, fine)
    atlas = require_atlas(arrays, geometry)
    orbifold = Orbifold(atlas, chi, about["orientable"], float(arrays["area"]))
    places = arrays["patch"], arrays["points"], arrays["transition"]
    density = arrays.get("density")
    if density is not None:
        require(np.isfinite(density) & (density > 0), "density", "numbers are finite and positive")
    marks = arrays.get("crease"), arrays.get("sites"), arrays.get("inside"), arrays.get("seam")
    triangulation = Triangulation(orbifold, fine, *places, about["group"], about["weights"], density, *marks)
    require_map(triangulation)
    require_creases(triangulation)
    require_inside(triangulation, refinement)
    origin, scale = arrays["origin"], float(arrays["scale"])
    for name in ("coefficients", "origin", "scale"):
        require(np.isfinite(arrays[name]), name, "numbers are finite")
    require(scale > 0, "scale", "it is positive")
    _require_sums(arrays, about)
    size = about["options"].get("size")
    return SurfaceMap(triangulation, refinement, origin, scale, size if isinstance(size, int) else None)


def _basis(make: Any, name: str, triangulation: Triangulation, options: Mapping[str, Any], path: Path) -> Any:
    try:
        return make(triangulation.orbifold, triangulation, **options)
    except OrbiframeError:
        raise
    except Exception as error:
        raise FormatError(
            f"{path}: the basis '{name}' cannot be made of it ({type(error).__name__}: {error}); fit the mesh again"
        ) from error


# ---- check sums ---------------------------------------------------------------------------------------------------


def _require_sums(arrays: Arrays, about: About) -> None:
    """Raise BrokenLaw for an array that is not the one that was saved."""
    if about["version"] == 1:
        return
    sums = about.get("sha256")
    if not isinstance(sums, dict):
        raise BrokenLaw("about", "it has a SHA-256 of every array")
    words = {key: value for key, value in about.items() if key != "sha256"}
    require(sums.get("about") == _sum_of_words(words), "about", "it is what was saved (SHA-256)")
    for name, array in arrays.items():
        require(sums.get(name) == _sum_of(array), name, "it is what was saved (SHA-256)")


def _sum_of(array: NDArray[Any]) -> str:
    return hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()


def _sum_of_words(about: About) -> str:
    return hashlib.sha256(json.dumps(about, sort_keys=True).encode()).hexdigest()


# ---- writing ------------------------------------------------------------------------------------------------------


def _about(surface: OrbifoldSurface) -> About:
    triangulation, orbifold = surface.triangulation, surface.orbifold
    return {
        "kind": _KIND,
        "version": _VERSION,
        "geometry": orbifold.geometry.name,
        "euler_characteristic": orbifold.euler_characteristic,
        "orientable": orbifold.orientable,
        "group": triangulation.group,
        "weights": triangulation.weights,
        "basis": surface.basis_name,
        "options": dict(surface.basis_options),
        **({} if surface.unit is None else {"unit": surface.unit}),
    }


def _arrays(surface: OrbifoldSurface) -> dict[str, NDArray[Any]]:
    triangulation = surface.triangulation
    found = {
        **{f"coarse_{name}": getattr(surface.refinement.coarse, name) for name in _MESH},
        **{f"fine_{name}": getattr(triangulation.polyhedron, name) for name in _MESH},
        **{f"atlas_{name}": getattr(surface.orbifold.atlas, name) for name in _ATLAS},
        "side": surface.refinement.side,
        "child": surface.refinement.child,
        "patch": triangulation.patch,
        "points": triangulation.points,
        "transition": triangulation.transition,
        "area": surface.orbifold.area,
        "coefficients": surface.coefficients,
        "origin": surface.origin,
        "scale": surface.scale,
    }
    found |= {name: array for name, array in _optional(surface).items() if array is not None}
    return {name: np.asarray(array, dtype=_KINDS[name][0]) for name, array in found.items()}


def _optional(surface: OrbifoldSurface) -> dict[str, NDArray[Any] | None]:
    log = surface.refinement.log
    steps = {} if log is None else {"flip_halfedge": log.halfedge, "flip_crossing": log.crossing}
    halved = {} if log is None or not log.halved.any() else {"flip_halved": log.halved}
    flat = surface.triangulation
    return {
        "density": flat.density,
        "crease": flat.crease,
        "sites": flat.sites,
        "inside": flat.inside,
        "seam": flat.seam,
        **steps,
        **halved,
    }
