"""Mapping: the mesh refined for as many functions as are wanted, and its map to X/H."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.geometry_names import geometry_name
from orbiframe.components.options import place_of
from orbiframe.delaunay.crease_domain import creased
from orbiframe.delaunay.crease_sites import Asked
from orbiframe.errors import ConfigError, MapError
from orbiframe.fitting.config import Config
from orbiframe.fitting.content import content_key, mesh_key, source_key
from orbiframe.fitting.correspondence import Carried, Correspondence
from orbiframe.fitting.made import made
from orbiframe.fitting.stages import Stages
from orbiframe.groups.group import Group
from orbiframe.groups.marked_group import MarkedGroup
from orbiframe.groups.marking import Marking
from orbiframe.meshes.bending import bending, sharp_edges
from orbiframe.meshes.bisection import Bisection, affordable_length, bisected, even_edge_length, triangles_made
from orbiframe.meshes.curving import Curving
from orbiframe.meshes.edge_log import EdgeLog
from orbiframe.meshes.fine_marks import fine_largest, fine_marks
from orbiframe.meshes.flat_flips import flat_flips
from orbiframe.meshes.intrinsic_refinement import intrinsic_refinement
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.regular_triangles import regular_triangles
from orbiframe.meshes.seams import seams
from orbiframe.meshes.submesh import submesh
from orbiframe.meshes.surface_type import SurfaceType
from orbiframe.planes.geometry import Geometry
from orbiframe.plugin import DEFAULT_MARKER
from orbiframe.triangulations.beyond import density_beyond
from orbiframe.triangulations.face_shapes import FaceShapes, face_shapes
from orbiframe.triangulations.triangulation import Triangulation
from orbiframe.workers.solving import solving_by

PARAMETRIZER = {"s2": "sphere", "e2": "harmonic", "h2": "harmonic"}
NAMED_PARAMETRIZER = {"s2": "sphere", "e2": "equivariant", "h2": "equivariant"}

_VERTICES_PER_FUNCTION = 6
_LEAST_VERTICES = 3000
# Bisection that makes more new triangles than this for each vertex that is aimed at cuts needles; so many vertices are
# put on their surface at most.
_NEEDLES, _MOST = 3, 20


class Mapped(NamedTuple):
    """A refined mesh and its map to X/H, as the parametrizer made it and as the optimizer left it.

    carried: how it was taken over, None where it was made.
    """

    refinement: Bisection
    first: Triangulation
    triangulation: Triangulation
    carried: Carried | None = None

    def with_density(self, density: NDArray[np.float64]) -> Mapped:
        """The same map, with so many functions per length wanted at its vertices."""
        return self._replace(triangulation=replace(self.triangulation, density=density))

    def face_shapes(self, polyhedron: Polyhedron) -> tuple[FaceShapes, FaceShapes | None]:
        """The faces of the polyhedron in X/H, and as they were before an optimizer changed them, if one did."""
        now = face_shapes(polyhedron, self.refinement, self.triangulation)
        same = self.first.points is self.triangulation.points
        return now, None if same else face_shapes(polyhedron, self.refinement, self.first)


@dataclass(frozen=True, eq=False)
class Mapping:
    """The maps of one polyhedron of unit size.

    triangles: its faces cut into triangles; inside: (F,), those of a mesh with a boundary, which the others only close,
    None where all are; closing: how it was closed; like: whose map is taken over, None for a map of its own; origin,
    scale: where and how large the polyhedron was; maps: the refinement and the map for every longest edge that has been
    needed so far.
    """

    polyhedron: Polyhedron
    triangles: Polyhedron
    surface_type: SurfaceType
    config: Config
    stages: Stages
    inside: NDArray[np.bool_] | None = None
    closing: str = "none"
    like: Correspondence | None = None
    origin: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    scale: float = 1.0
    maps: dict[float, Mapped] = field(default_factory=dict)

    @cached_property
    def flips(self) -> EdgeLog | None:
        """Needles in plane parts of the polyhedron, gone; an optimizer of its faces needs their own triangles."""
        return flat_flips(self.triangles, self.inside) if self.config.shape.open else None

    @property
    def facets(self) -> Polyhedron:
        """The triangles after the flips."""
        return self.triangles if self.flips is None else self.flips.after

    @property
    def own_facets(self) -> Polyhedron:
        """Those that belong to the mesh, without those that only close it."""
        return self.facets if self.inside is None else submesh(self.facets, self.inside).mesh

    def _refined(self, longest: float, vertices: int) -> Bisection:
        """The mesh with no edge longer than `longest`; needles by the thousand are not halved each for itself.

        Where creases are kept, they are: a crease stays a chain of edges. So does a boundary.
        """
        log, expected = self.flips, triangles_made(self.facets, longest)
        if (
            log is not None
            and self.config.data.creases is None
            and self.inside is None
            and expected > _NEEDLES * vertices + self.facets.face_count
        ):
            log = intrinsic_refinement(log, longest, _MOST * vertices)
        facets = self.triangles if log is None else log.after
        return bisected(self.triangles, affordable_length(facets, longest, vertices), True, log)

    def for_size(self, size: int) -> Mapped:
        """The mesh refined so that samples and centres are dense enough for so many functions, and its map to X/H."""
        vertices = max(_LEAST_VERTICES, _VERTICES_PER_FUNCTION * size)
        if self.like is not None and self.like.serves(self.triangles, vertices):
            return self._taken_over(0.0, lambda like: like.moved(self.triangles))
        longest = even_edge_length(self.facets, vertices)
        if self.like is not None:
            return self._taken_over(longest, partial(self._refined_like, longest, vertices))
        if longest not in self.maps:
            refinement = self.stages("refinement", self._refined, longest, vertices)
            self.maps[longest] = self._mapped(refinement, refinement.polyhedron)
        return self.maps[longest]

    def _refined_like(self, longest: float, vertices: int, like: Correspondence) -> Carried:
        return like.refined(self._refined(longest, vertices), self.origin, self.scale)

    def _taken_over(self, key: float, take: Callable[[Correspondence], Carried]) -> Mapped:
        """The map that is taken over; once for each longest edge."""
        assert self.like is not None
        if key not in self.maps:
            found: Carried = self.stages("map", take, self.like)
            first = self._bounded(found.refinement, found.triangulation)
            self.maps[key] = Mapped(found.refinement, first, first, found)
        return self.maps[key]

    def creased(self, mapped: Mapped, size: int, unknowns: tuple[int, int, int], most: int) -> Mapped:
        """The map with creases where the mesh is sharp, and seams where plane faces end; see `data.creases`.

        For about `size` functions, or up to `most` where curved parts ask for them. unknowns: of which so many belong
        to a vertex, an edge and a triangle of the domain.
        """
        refinement = mapped.refinement
        sharp = self.sharp(refinement.facets)
        soft = seams(refinement.facets, sharp)
        crease, seam = fine_marks(refinement, sharp | soft), fine_marks(refinement, soft) if soft.any() else None
        kept = None if self.like is None else self.like.creased(mapped.triangulation, crease, size)
        asked = Asked(size, unknowns, fine_largest(refinement, Curving.of(refinement.facets, sharp).curvatures), most)
        found = creased(mapped.triangulation, crease, asked, seam) if kept is None else kept
        unshaped = mapped.first.points is mapped.triangulation.points
        return mapped._replace(first=found if unshaped else mapped.first, triangulation=found)

    def sharp(self, mesh: Polyhedron) -> NDArray[np.bool_]:
        """The creases of the triangles, or of the facets, (H,). Raises ConfigError where there is none."""
        degrees = self.config.data.creases
        assert degrees is not None
        if degrees == "marked":
            return self._marked(mesh)
        found = sharp_edges(mesh, degrees)
        if not found.any():
            sharpest = float(np.degrees(bending(mesh).angle.max()))
            raise ConfigError(
                f"{place_of('data.creases', self.config.places)}no edge of the mesh bends by {degrees:g}° or more (the "
                f"sharpest by {sharpest:.1f}°), so that there is no crease; take a smaller angle, or leave it out"
            )
        return found

    def _marked(self, mesh: Polyhedron) -> NDArray[np.bool_]:
        marked = self.triangles.marked
        found = None if marked is None else marked.among(mesh.tail, mesh.head)
        if found is None or not found.any():
            known = "none is" if marked is None else f"of {len(marked.ends)} marks none belongs to an edge of a face"
            raise ConfigError(
                f"{place_of('data.creases', self.config.places)}no edge of the mesh is marked as sharp ({known}); "
                "marks are an element 'edge' with vertex1, vertex2 and crease in PLY, and lines "
                "'t crease 2/1/0 v w sharpness' in OBJ; or give an angle"
            )
        return found

    def of_lifted(self, mapped: Mapped, lifted: Polyhedron) -> Mapped:
        """The map of the refined mesh with its vertices moved; the one before, if those cannot be mapped.

        A map that is taken over stays as it is.
        """
        if self.like is not None:
            moved = replace(mapped.triangulation, polyhedron=lifted)
            return mapped._replace(first=moved, triangulation=moved)
        try:
            again = self._mapped(mapped.refinement, lifted)
        except MapError:
            return mapped
        density = mapped.triangulation.density
        return again if density is None else again.with_density(density)

    def _mapped(self, refinement: Bisection, mesh: Polyhedron) -> Mapped:
        """The map of a mesh that is connected like the refinement, verified."""
        geometry = self._geometry()
        group = None if self.config.group.open else self._named_group(mesh, geometry)
        plane = geometry_name(self.surface_type.euler_characteristic)
        name = (PARAMETRIZER if group is None else NAMED_PARAMETRIZER)[plane]
        name = name if self.config.map.open else self.config.map.name
        registry = self.stages.registry
        parametrizer = self.config.component("map", registry, name)
        triangulation = self.stages.mapped(
            "map",
            lambda: self._key("map", name, parametrizer, mesh_key(mesh)),
            mesh,
            geometry,
            lambda: made(
                registry, "parametrizer", name, self._solved(parametrizer, mesh, geometry, group), Triangulation
            ),
        )
        remedy = "map.method = 'auto'" + ("" if group is None else " or group.method = 'mesh'")
        _require_embedding(triangulation, f"the map of '{name}'", remedy)
        first = self._bounded(refinement, triangulation)
        return Mapped(refinement, first, self._bounded(refinement, self._shaped(refinement, first)))

    def _solved(self, parametrizer: Callable[..., object], *given: object) -> object:
        """What a parametrizer makes, with the solver that is chosen."""
        step = self.config.solver
        with solving_by(None if step.open else self.config.component("solver", self.stages.registry)):
            return parametrizer(*given)

    def _bounded(self, refinement: Bisection, triangulation: Triangulation) -> Triangulation:
        """The map with the triangles marked that belong to the mesh, and with fewer functions on the others."""
        if self.inside is None or triangulation.inside is not None:
            return triangulation
        marks = np.repeat(self.inside.astype(float), 3).reshape(-1, 3, 1)
        marked = replace(triangulation, inside=refinement.spread(marks)[:, 0, 0] > 0.5)
        return replace(marked, density=density_beyond(marked, doubled=self.closing == "double"))

    def _geometry(self) -> Geometry:
        """The plane that the configuration names, or that of the Euler characteristic."""
        chi = self.surface_type.euler_characteristic
        step = self.config.geometry
        name = geometry_name(chi) if step.open else step.name
        found = self.config.component("geometry", self.stages.registry, name)()
        geometry = made(self.stages.registry, "geometry", name, found, Geometry)  # type: ignore[type-abstract]
        if geometry.curvature != (chi > 0) - (chi < 0):
            raise MapError(
                f"a surface of Euler characteristic {chi} is made of {geometry_name(chi)}, and '{name}' has the "
                f"curvature {geometry.curvature}; leave out geometry.name, or name another geometry"
            )
        return geometry

    def _shaped(self, refinement: Bisection, first: Triangulation) -> Triangulation:
        """The map changed so that the faces of the polyhedron become regular, where an optimizer is named."""
        step = self.config.shape
        if step.open:
            return first
        target = refinement.spread(regular_triangles(self.polyhedron))
        registry = self.stages.registry
        optimizer = self.config.component("shape", registry)
        shaped = self.stages.mapped(
            "shape",
            lambda: self._key("shape", step.name, optimizer, _map_key(first), mesh_key(self.polyhedron)),
            first.polyhedron,
            first.orbifold.geometry,
            lambda: made(registry, "optimizer", step.name, optimizer(first, target), Triangulation),
        )
        _require_embedding(shaped, f"the shapes of '{step.name}'", "shape.method = 'none'")
        return shaped

    def _key(self, table: str, name: str, maker: Callable[..., Triangulation], *content: str) -> str:
        """The content key of a map: the mesh, the component with its options and source, the group."""
        solver = () if self.config.solver.open else ("solver",)
        steps = {other: self.config.steps[other] for other in (table, "geometry", "group", "marking", *solver)}
        chosen = {other: (step.name, dict(step.options)) for other, step in steps.items()}
        return content_key({"component": (table, name), "steps": chosen, "source": source_key(maker), "of": content})

    def _named_group(self, mesh: Polyhedron, geometry: Geometry) -> MarkedGroup:
        """The mesh cut open to a disc, and the group that the configuration names with the word of its boundary."""
        config, registry = self.config, self.stages.registry
        name = DEFAULT_MARKER if config.marking.open else config.marking.name
        marker = config.component("marking", registry, name)
        marking = made(self.stages.registry, "marker", name, self.stages("marking", marker, mesh), Marking)
        found = self.stages("group", config.component("group", registry), geometry, marking.word)
        group = made(self.stages.registry, "group", config.group.name, found, Group)  # type: ignore[type-abstract]
        return MarkedGroup(group, marking, config.group.name)


def _map_key(triangulation: Triangulation) -> str:
    """The SHA-256 of a map, to the last bit."""
    atlas = triangulation.orbifold.atlas
    arrays = (triangulation.patch, triangulation.points, triangulation.transition, atlas.isometry, atlas.radius)
    return hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest()


def _require_embedding(triangulation: Triangulation, made: str, remedy: str) -> None:
    if triangulation.not_positive:
        count = triangulation.polyhedron.face_count
        raise MapError(f"{triangulation.not_positive} of {count} triangles are folded in {made}; use {remedy}")
