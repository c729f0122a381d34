"""Remeshing: how many vertices make edges of a length, and the mesh that has them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from orbiframe import FitError, Orbifold, OrbifoldSurface, Polyhedron, UsageError
from orbiframe.meshes import require_closed_surface
from orbiframe_remeshing.even_sites import creased_mesh, even_mesh, surface_area
from orbiframe_remeshing.quads import quadrilaterals
from orbiframe_remeshing.relaxation import relaxed
from orbiframe_remeshing.surface_mesh import SurfaceMesh

Progress = Callable[[str, float | None], None]

# A vertex of even triangles, or a square, has so much area for edges of length 1.
_AREA = {False: math.sqrt(3) / 2, True: 1.0}
LEAST, MOST = 4, 500_000


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

    def total(self, area: float) -> float:
        """The number of vertices of a mesh of so much area; of those that a length makes raises FitError for many."""
        if self.vertices is not None:
            return self.vertices
        assert self.edge_length is not None
        count = area / _AREA[self.quads] / self.edge_length**2
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
    count = (vertices + 5 * float(surface.orbifold.euler_characteristic)) / 6 if quads else vertices
    mesh = even_triangles(surface, count, seed)
    if not quads:
        return mesh.polyhedron()
    made = quadrilaterals(mesh)
    _require_topology(made, surface.orbifold)
    return made


def even_triangles(surface: OrbifoldSurface, vertices: float, seed: int = 0) -> SurfaceMesh:
    """Even triangles on a surface, with so many vertices. Raises FitError as `remeshed` does.

    On one with creases these are edges, and there are only about so many vertices.
    """
    count = max(round(vertices), LEAST)
    creased = surface.triangulation.crease is not None
    mesh = relaxed(creased_mesh(surface, count) if creased else even_mesh(surface, count, seed))
    _require_topology(mesh.polyhedron(), surface.orbifold)
    return mesh


def _require_topology(made: Polyhedron, orbifold: Orbifold) -> None:
    found = require_closed_surface(made)
    if (found.euler_characteristic, found.orientable) != (orbifold.euler_characteristic, orbifold.orientable):
        raise FitError(
            f"{len(made.vertices)} vertices make a mesh that is {found.name}, which is not the surface; take more of "
            "them, or shorter edges"
        )


def areas_of(surfaces: list[OrbifoldSurface]) -> list[float]:
    """The areas in space of several surfaces."""
    return [surface_area(surface) for surface in surfaces]
