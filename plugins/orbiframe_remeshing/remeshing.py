"""Remeshing: how many vertices make edges of a length, and the mesh that has them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from orbiframe import FitError, OrbifoldSurface, Polyhedron, UsageError, surface_type
from orbiframe.meshes import boundary_loops, require_closed_surface
from orbiframe.surfaces import border_curves, edge_for
from orbiframe_remeshing.even_sites import creased_mesh, even_mesh, surface_area
from orbiframe_remeshing.open_sites import open_mesh
from orbiframe_remeshing.quads import quadrilaterals
from orbiframe_remeshing.relaxation import relaxed
from orbiframe_remeshing.surface_mesh import SurfaceMesh

Progress = Callable[[str, float | None], None]

# A vertex of even triangles, or a square, has so much area for edges of length 1.
_AREA = {False: math.sqrt(3) / 2, True: 1.0}
LEAST, MOST = 4, 500_000
# Rounds in which the number of vertices on a boundary is found.
_TURNS = 6


@dataclass(frozen=True)
class Wanted:
    """What is asked for: edges of a length or a number of vertices, of triangles or of quadrilaterals."""

    edge_length: float | None = None
    vertices: int | None = None
    quads: bool = False

    def __post_init__(self) -> None:
        """Raise UsageError for a length or a number that no mesh has."""
        if self.edge_length is not None and not (self.edge_length > 0 and math.isfinite(self.edge_length)):
            raise UsageError(f"--edge-length {self.edge_length:g}: give a positive length, in units of the mesh")
        if self.vertices is not None and not LEAST <= self.vertices <= MOST:
            raise UsageError(f"--vertices {self.vertices}: give {LEAST} to {MOST}")

    def total(self, area: float, rim: float = 0.0) -> float:
        """The number of vertices of a mesh of so much area, and so long a boundary.

        Raises FitError where a length makes too many or too few.
        """
        if self.vertices is not None:
            return self.vertices
        assert self.edge_length is not None
        count = area / _AREA[self.quads] / self.edge_length**2 + rim / self.edge_length / 2
        if not LEAST <= count <= MOST:
            longest, shortest = (math.sqrt(area / _AREA[self.quads] / n) for n in (LEAST, MOST))
            raise FitError(
                f"--edge-length {self.edge_length:g} makes about {count:.0f} vertices on an area of {area:.6g}; give "
                f"{shortest:.3g} to {longest:.3g}"
            )
        return count


def remeshed(surface: OrbifoldSurface, vertices: float, *, quads: bool = False, seed: int = 0) -> Polyhedron:
    """Even triangles, or quadrilaterals, on a surface, with its normals; about so many vertices, of triangles exactly.

    Raises FitError where there are too few to tell the faces apart by their vertices.
    """
    mesh = even_triangles(surface, _for_quads(surface, vertices) if quads else vertices, seed)
    if not quads:
        return mesh.polyhedron()
    made = quadrilaterals(mesh)
    _require_topology(made, surface)
    return made


def _for_quads(surface: OrbifoldSurface, vertices: float) -> float:
    """How many vertices triangles have of which quadrilaterals have so many: V become 6 V - 5 chi - 2 B."""
    chi, area, rim = surface_type(surface.own_mesh).euler_characteristic, surface_area(surface), rim_length(surface)
    count = (vertices + 5 * chi) / 6
    for _ in range(_TURNS if rim else 0):
        count = (vertices + 5 * chi + 2 * rim / edge_for(max(count, 1), area, rim)) / 6
    return count


def even_triangles(surface: OrbifoldSurface, vertices: float, seed: int = 0) -> SurfaceMesh:
    """Even triangles on a surface, with so many vertices. Raises FitError as `remeshed` does.

    On one with creases these are edges, and there are only about so many vertices.
    """
    count = max(round(vertices), LEAST)
    mesh = relaxed(_first_triangles(surface, count, seed))
    _require_topology(mesh.polyhedron(), surface)
    return mesh


def _first_triangles(surface: OrbifoldSurface, count: int, seed: int) -> SurfaceMesh:
    if surface.triangulation.inside is not None:
        return open_mesh(surface, count, seed)
    return creased_mesh(surface, count) if surface.triangulation.crease is not None else even_mesh(surface, count, seed)


def _require_topology(made: Polyhedron, surface: OrbifoldSurface) -> None:
    found = require_closed_surface(made, boundary=surface.triangulation.inside is not None)
    if found != surface_type(surface.own_mesh) or len(boundary_loops(made)) != len(border_curves(surface)):
        raise FitError(
            f"{len(made.vertices)} vertices make a mesh that is {found.name}, which is not the surface; take more of "
            "them, or shorter edges"
        )


def areas_of(surfaces: list[OrbifoldSurface]) -> list[float]:
    """The areas in space of several surfaces."""
    return [surface_area(surface) for surface in surfaces]


def rim_length(surface: OrbifoldSurface) -> float:
    """The length in space of the boundary of a surface; 0 for a closed one."""
    return sum((curve.length for curve in border_curves(surface)), 0.0) * surface.scale
