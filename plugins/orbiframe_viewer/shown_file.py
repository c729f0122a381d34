"""Shown file: the scenes of a mesh, which is fitted first, of a saved surface, or of a field."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from orbiframe import Config, Polyhedron, Registry, load_surface, read
from orbiframe.files import confined_tables
from orbiframe.fitting import fit_parts
from orbiframe.surfaces import shaded_picture
from orbiframe_viewer.scene import Scene, field_scene, surface_scene

SURFACES = (".npz", ".orbi")
# Of the files of these suffixes the numbers at their points are looked for.
FIELDS = (".ply", ".vtu", ".vtk")


def scenes_of(
    path: Path,
    config: Config,
    registry: Registry,
    progress: Callable[[str, float | None], None],
    repair: Callable[[Polyhedron], Polyhedron] | None = None,
) -> tuple[list[Scene], bytes]:
    """The scenes of a file, one for each surface in it, and a picture of the first. Raises what `fit` raises.

    repair: what is done to a mesh before it is fitted.
    """
    name = path.stem
    if path.suffix.lower() in SURFACES:
        surface = load_surface(path, registry)
        return [surface_scene(surface, None, name)], surface.picture().png
    if repair is None and (found := _field(path, registry)):
        return [found[0]], found[1]
    mesh = path if repair is None else repair(_read(path, config, registry))
    parts = fit_parts(mesh, config, registry, progress)
    progress("scene", None)
    several = len(parts.results) > 1
    scenes = [
        surface_scene(result.surface, result.input, f"{name}, part {number}" if several else name)
        for number, result in enumerate(parts.results, start=1)
    ]
    return scenes, parts.results[0].surface.picture().png


def _read(path: Path, config: Config, registry: Registry) -> Polyhedron:
    """The mesh with all its faces, those without area too, for repairs to see."""
    return read(path, registry, format=None if config.mesh.open else config.mesh.name, degenerate=True)


def _field(path: Path, registry: Registry) -> tuple[Scene, bytes] | None:
    """The scene of a mesh with numbers at its vertices, and a picture; None for a mesh without."""
    if path.suffix.lower() not in FIELDS or not path.is_file():
        return None
    tables = confined_tables("orbiframe_viewer.attributes:columns_of", path)
    if not len(tables["names"]):
        return None
    from scipy.spatial import cKDTree

    mesh = read(path, registry)
    nearest = np.asarray(cKDTree(tables["places"]).query(mesh.vertices)[1])
    columns = {str(title): tables[str(k)][nearest] for k, title in enumerate(tables["names"])}
    return field_scene(mesh, columns, path.stem), shaded_picture(mesh).png
