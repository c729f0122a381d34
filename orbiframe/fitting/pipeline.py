"""Pipeline: from a mesh file to one smooth surface, in the steps of section 3.4 of the paper."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.options import options_of
from orbiframe.components.registry import Registry
from orbiframe.errors import FitError, MapError, TopologyError
from orbiframe.files import gate
from orbiframe.fitting.config import Config
from orbiframe.fitting.limits import require_density
from orbiframe.fitting.report import Deviation, report
from orbiframe.functions.samples import Samples, coordinate_samples
from orbiframe.groups.marked_group import MarkedGroup
from orbiframe.meshes.bisection import Bisection, bisected, edge_length_for
from orbiframe.meshes.defects import require_closed_surface
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.orientation import oriented
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.regular_triangles import regular_triangles
from orbiframe.meshes.surface_type import SurfaceType, without_unused_vertices
from orbiframe.meshes.told_by_ends import require_told_by_ends
from orbiframe.planes.geometry import Geometry
from orbiframe.plugin import DEFAULT_MARKER
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.triangulations.face_shapes import FaceShapes, face_shapes
from orbiframe.triangulations.triangulation import Triangulation

Progress = Callable[[str, float | None], None]

PARAMETRIZER = {"s2": "sphere", "e2": "harmonic", "h2": "harmonic"}
NAMED_PARAMETRIZER = {"s2": "sphere", "e2": "equivariant", "h2": "equivariant"}

_VERTICES_PER_FUNCTION = 6
_LEAST_VERTICES = 3000
_OUTPUT_FACES = 40_000
_FIRST_SIZE, _LARGEST_SIZE = 250, 16_000


@dataclass(frozen=True, eq=False)
class Result:
    """What a fit returns: the surface, a mesh on it with normals, and the report of all steps as plain data."""

    surface: OrbifoldSurface
    output: Polyhedron
    report: dict[str, Any]


@dataclass(frozen=True, eq=False)
class _Stages:
    """Runs the steps, tells who listens, and keeps the seconds."""

    registry: Registry
    progress: Progress
    seconds: dict[str, float] = field(default_factory=dict)

    def __call__(self, name: str, step: Callable[..., Any], *arguments: Any) -> Any:
        self.progress(name, None)
        start = time.perf_counter()
        result = step(*arguments)
        seconds = time.perf_counter() - start
        self.seconds[name] = self.seconds.get(name, 0.0) + seconds
        self.registry.stage_done(name, result, seconds)
        self.progress(name, seconds)
        return result


def _silent(_stage: str, _seconds: float | None) -> None: ...


def fit(mesh: str | Path | Polyhedron, config: Config, registry: Registry, progress: Progress = _silent) -> Result:
    """The smooth surface of a closed polyhedron, given as a file or as an object.

    progress: called with the name of each stage at its start (seconds None) and at its end. Raises FormatError,
    TopologyError, MapError, FitError or ConfigError, each a sentence with a next step.
    """
    stages = _Stages(registry, progress)
    config = config.checked(registry)
    polyhedron = mesh if isinstance(mesh, Polyhedron) else stages("read", _read, Path(mesh), config, registry)
    surface_type = stages("topology", require_closed_surface, polyhedron)
    require_density(config.output.refine, int((polyhedron.face_sizes - 2).sum()), config.places)
    unit, origin, scale = _normalised(oriented(without_unused_vertices(polyhedron)))
    triangles = stages("triangles", triangulated, unit)
    fitted = _Approximation(unit, triangles, surface_type, config, registry, stages).fitted()
    surface = replace(fitted.surface, origin=origin, scale=scale)
    density = config.output.refine or max(1, round(np.sqrt(_OUTPUT_FACES / triangles.face_count)))
    output = stages("tessellation", surface.tessellate, density)
    require_told_by_ends(output, surface_type)
    faces = fitted.mapped.face_shapes(unit)
    summary = report(
        surface, surface_type, unit, config, fitted.samples, fitted.deviation, faces, output, stages.seconds
    )
    return Result(surface, output, summary)


class _Mapped(NamedTuple):
    """A refined mesh and its map to X/H, as the parametrizer made it and as the optimizer left it."""

    refinement: Bisection
    first: Triangulation
    triangulation: Triangulation

    def face_shapes(self, polyhedron: Polyhedron) -> tuple[FaceShapes, FaceShapes | None]:
        """The faces of the polyhedron in X/H, and as they were before an optimizer changed them, if one did."""
        now = face_shapes(polyhedron, self.refinement, self.triangulation)
        same = self.first is self.triangulation
        return now, None if same else face_shapes(polyhedron, self.refinement, self.first)


class _Fitted(NamedTuple):
    """A surface for a mesh of unit size, its map, what it was fitted to, and how well."""

    surface: OrbifoldSurface
    mapped: _Mapped
    samples: Samples
    deviation: Deviation


@dataclass(frozen=True, eq=False)
class _Approximation:
    """The approximation of one polyhedron of unit size, with as many functions as are asked for.

    triangles: its faces cut into triangles; maps: the refinement and the map for every longest edge that has been
    needed so far.
    """

    polyhedron: Polyhedron
    triangles: Polyhedron
    surface_type: SurfaceType
    config: Config
    registry: Registry
    stages: _Stages
    maps: dict[float, _Mapped] = field(default_factory=dict)

    def fitted(self) -> _Fitted:
        """The surface of a fixed number of functions, or of as many as the tolerance asks for."""
        tolerance = self.config.output.tolerance
        if tolerance is None:
            return self._of_size(_size(self.config, self.registry), self.config)
        size = _FIRST_SIZE
        while True:
            fitted = self._of_size(size, self.config.with_options("basis", size=size))
            if fitted.deviation.rms <= tolerance:
                return fitted
            if 2 * size > _LARGEST_SIZE:
                raise FitError(
                    f"{size} functions reach an error of {fitted.deviation.rms:.2e}, not {tolerance:.2e}; "
                    "sharp edges converge slowly: allow a larger tolerance, or set basis.size yourself"
                )
            size *= 2

    def _of_size(self, size: int, config: Config) -> _Fitted:
        stages = self.stages
        mapped = self._map(size)
        refinement, triangulation = mapped.refinement, mapped.triangulation
        samples = stages("samples", coordinate_samples, triangulation)
        basis = stages("basis", config.component("basis", self.registry), triangulation.orbifold, triangulation)
        fitter = config.component("fitter", self.registry)()
        coefficients = stages("fit", fitter.fit, basis, samples)
        recipe = config.basis.name, _basis_options(config, self.registry)
        surface = OrbifoldSurface(triangulation, refinement, basis, coefficients, np.zeros(3), 1.0, *recipe)
        return _Fitted(surface, mapped, samples, stages("error", _deviation, surface, samples))

    def _map(self, size: int) -> _Mapped:
        """The mesh refined so that samples and centres are dense enough for the basis, and its map to X/H."""
        longest = edge_length_for(self.triangles, max(_LEAST_VERTICES, _VERTICES_PER_FUNCTION * size))
        if longest not in self.maps:
            refinement = self.stages("refinement", bisected, self.triangles, longest, True)
            first = _mapped(refinement.polyhedron, self.surface_type, self.config, self.registry, self.stages)
            self.maps[longest] = _Mapped(refinement, first, self._shaped(refinement, first))
        return self.maps[longest]

    def _shaped(self, refinement: Bisection, first: Triangulation) -> Triangulation:
        """The map changed so that the faces of the polyhedron become regular, where an optimizer is named."""
        step = self.config.shape
        if step.open:
            return first
        target = refinement.spread(regular_triangles(self.polyhedron))
        optimizer = self.config.component("shape", self.registry)
        shaped: Triangulation = self.stages("shape", optimizer, first, target)
        _require_embedding(shaped, f"the shapes of '{step.name}'", "shape.method = 'none'")
        return shaped


def _read(path: Path, config: Config, registry: Registry) -> Polyhedron:
    return gate.read(path, registry, format=None if config.mesh.open else config.mesh.name)


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


def _basis_options(config: Config, registry: Registry) -> dict[str, Any]:
    """All options of the basis, those given and the defaults of the others."""
    options = options_of(registry.load("basis", config.basis.name))
    return {option.name: config.basis.options.get(option.name, option.default) for option in options}


def _size(config: Config, registry: Registry) -> int:
    """The number of functions that the basis will have, as far as its options tell."""
    return int(_basis_options(config, registry).get("size", 1000))


def _mapped(
    mesh: Polyhedron, surface_type: SurfaceType, config: Config, registry: Registry, stages: _Stages
) -> Triangulation:
    """The map to X/H, verified; the sign of the Euler characteristic chooses the geometry."""
    geometry: Geometry = registry.geometry(surface_type.euler_characteristic)
    group = None if config.group.open else _named_group(mesh, geometry, config, registry, stages)
    chosen = PARAMETRIZER if group is None else NAMED_PARAMETRIZER
    name = chosen[geometry.name] if config.map.open else config.map.name
    triangulation: Triangulation = stages("map", config.component("map", registry, name), mesh, geometry, group)
    remedy = "map.method = 'auto'" + ("" if group is None else " or group.method = 'mesh'")
    _require_embedding(triangulation, f"the map of '{name}'", remedy)
    return triangulation


def _require_embedding(triangulation: Triangulation, made: str, remedy: str) -> None:
    if triangulation.not_positive:
        count = triangulation.polyhedron.face_count
        raise MapError(f"{triangulation.not_positive} of {count} triangles are folded in {made}; use {remedy}")


def _named_group(
    mesh: Polyhedron, geometry: Geometry, config: Config, registry: Registry, stages: _Stages
) -> MarkedGroup:
    """The mesh cut open to a disc, and the group that the configuration names with the word of its boundary."""
    name = DEFAULT_MARKER if config.marking.open else config.marking.name
    marking = stages("marking", config.component("marking", registry, name), mesh)
    group = stages("group", config.component("group", registry), geometry, marking.word)
    return MarkedGroup(group, marking, config.group.name)


def _deviation(surface: OrbifoldSurface, samples: Samples) -> Deviation:
    """Distances between the surface and the samples, for a mesh of unit diagonal."""
    distance = np.linalg.norm(surface.evaluate(samples.points) - samples.values, axis=1)
    rms = float(np.sqrt(samples.weights @ distance**2 / samples.weights.sum()))
    return Deviation(rms, float(distance.max()))
