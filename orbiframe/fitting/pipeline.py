"""Pipeline: from a mesh file to one smooth surface, in the steps of section 3.4 of the paper."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.registry import Registry
from orbiframe.errors import Notice, TopologyError
from orbiframe.files import gate
from orbiframe.fitting.approximation import Approximations
from orbiframe.fitting.closed_mesh import mapping_of
from orbiframe.fitting.config import Config, Output
from orbiframe.fitting.correspondence import Correspondence
from orbiframe.fitting.given_back import GivenBack
from orbiframe.fitting.inspection import inspected
from orbiframe.fitting.kept_maps import KeptMaps
from orbiframe.fitting.limits import require_density
from orbiframe.fitting.report import report
from orbiframe.fitting.settings import configured
from orbiframe.fitting.stages import Progress, Stages
from orbiframe.fitting.told import told
from orbiframe.functions.samples import Samples
from orbiframe.meshes.defects import require_closed_surface
from orbiframe.meshes.foreign_meshes import polyhedron_of
from orbiframe.meshes.orientation import oriented
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.surface_type import without_unused_vertices
from orbiframe.meshes.told_by_ends import require_told_by_ends
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.surfaces.textures import texture_coordinates
from orbiframe.workers.linear_algebra import one_thread

_OUTPUT_FACES = 40_000


@dataclass(frozen=True, eq=False, repr=False)
class Result(GivenBack):
    """What a fit returns: the surface, a mesh on it with normals, and the report of all steps as plain data.

    input: the mesh, oriented, all of whose vertices are in faces; its triangles are `surface.refinement.coarse`.
    samples: what was fitted, of a mesh of unit size at the origin.

    >>> from orbiframe import fit
    >>> result = fit("dataset:sphere", size=60)
    >>> result.report["fit"]["rms"] < 1e-2
    True
    >>> mesh = result.to_meshio()
    >>> len(mesh.points) == len(result.output.vertices)
    True
    """

    surface: OrbifoldSurface
    output: Polyhedron
    report: dict[str, Any]
    input: Polyhedron
    samples: Samples


def fit(
    mesh: object,
    config: Config | None = None,
    registry: Registry | None = None,
    progress: Progress | Literal[False] | None = None,
    *,
    share: float = 1.0,
    maps: KeptMaps | None = None,
    like: OrbifoldSurface | str | Path | None = None,
    **settings: Any,
) -> Result:
    """The smooth surface of a polyhedron: `fit("shape.off", size=500)`; with a boundary: `boundary="auto"` as well.

    mesh: the name of a file; a Polyhedron; a pair (vertices, faces); or a mesh of trimesh, PyVista, meshio or Open3D,
    see `Polyhedron.of`. config: by default that of an empty file; registry: by default all that is installed. progress:
    called with the name of each stage at its start (seconds None) and at its end; None says what takes long on the
    standard error stream, False nothing. share: of the faces that a fine picture needs; maps: a folder from which maps
    to X/H are taken where they are there, and in which they are kept. like: a surface, or the file of one, whose map is
    taken over by this mesh, which is the same one moved, or cut otherwise; MapError says when it does not serve.

    settings: what is to differ from the configuration: `size`, `tolerance`, `max_error`, `refine`, `boundary` and
    `fast=True` as on the command line; a table by its name, `basis="ps2"` or
    `fitter={"name": "smoothing", "fairing": 1e-3}`. Raises FormatError, TopologyError, MapError, FitError or
    ConfigError, each a sentence with a next step, and UsageError for an unknown keyword or what is no mesh.

    >>> import orbiframe
    >>> result = orbiframe.fit("dataset:torus", size=60)
    >>> result.report["surface"]["euler_characteristic"]
    0
    >>> len(result.output.normals) == len(result.output.vertices)
    True
    """
    known = Correspondence.of_surface(like) if isinstance(like, OrbifoldSurface) else None
    file = None if like is None or known is not None else str(like)
    config = configured(config, settings | {"like": file})
    registry = registry_for(config) if registry is None else registry
    with told(progress) as heard, one_thread():
        return _fitted(mesh, config, Stages(registry, heard, maps=maps), share, known)


def _fitted(mesh: object, config: Config, stages: Stages, share: float, like: Correspondence | None) -> Result:
    registry = stages.registry
    config = config.checked(registry)
    if config.like is not None and like is None:
        like = Correspondence.of_file(config.like, registry)
    polyhedron = mesh if isinstance(mesh, Polyhedron) else stages("read", mesh_of, mesh, config, registry)
    surface_type = stages("topology", partial(require_closed_surface, boundary=config.boundary != "error"), polyhedron)
    require_density(config.output.refine, int((polyhedron.face_sizes - 2).sum()), config.places)
    if polyhedron.corner_uv is not None:
        _tell_textures_left()
        polyhedron = replace(polyhedron, corner_uv=None)
    placed = oriented(without_unused_vertices(polyhedron))
    placed = placed if like is None else like.cut(placed)
    unit, origin, scale = _normalised(placed)
    mapping = replace(mapping_of(unit, config, stages, like), origin=origin, scale=scale)
    found = Approximations(mapping, config, stages).wanted()
    surface = replace(found.surface, origin=origin, scale=scale)
    output = stages("tessellation", _tessellated, surface, config.output, share * _OUTPUT_FACES)
    require_told_by_ends(output, surface_type)
    inspection = stages("inspection", inspected, surface, output, config.output.refine is None)
    summary = report(surface, surface_type, mapping, config, found, output, inspection, stages.seconds)
    return Result(surface, output, summary, placed, found.samples)


def _tessellated(surface: OrbifoldSurface, output: Output, wanted: float) -> Polyhedron:
    """Every triangle of the input cut alike, or the refined mesh cut so that it has about as many faces as wanted."""
    faces, bisected = len(surface.triangulation.own_faces), output.refine is None
    density = max(1, round(math.sqrt(wanted / faces))) if output.refine is None else output.refine
    mesh = surface.tessellate(density, bisected=bisected)
    return replace(mesh, corner_uv=texture_coordinates(surface, density, bisected=bisected)) if output.uv else mesh


def _tell_textures_left() -> None:
    told = "the texture coordinates of the mesh are not those of the surface and are left out; --uv makes new ones"
    warnings.warn(told, Notice, stacklevel=4)


def registry_for(config: Config) -> Registry:
    """All that is installed, with the plugin files of a configuration."""
    return Registry.discover(files=config.plugins)


def mesh_of(mesh: object, config: Config, registry: Registry) -> Polyhedron:
    """The polyhedron of a file, by the reader that the configuration names or the suffix, or of an object."""
    if not isinstance(mesh, str | Path):
        return polyhedron_of(mesh)
    return gate.read(Path(mesh), registry, format=None if config.mesh.open else config.mesh.name)


def _normalised(polyhedron: Polyhedron) -> tuple[Polyhedron, NDArray[np.float64], float]:
    """The polyhedron moved to the origin and scaled to a bounding box of diagonal 1, with where it was."""
    low, high = polyhedron.vertices.min(axis=0), polyhedron.vertices.max(axis=0)
    origin = low / 2 + high / 2
    centred = polyhedron.vertices - origin
    scale = 2 * math.hypot(*(high / 2 - low / 2))
    if scale == 0:
        raise TopologyError("all vertices of the mesh lie in one point; a surface needs some extent")
    if not math.isfinite(scale):
        raise TopologyError("the bounding box of the mesh has a diagonal beyond 1.8e308; scale the mesh down")
    return polyhedron.with_vertices(centred / scale), origin, scale
