"""Inspection: what is wrong with a surface, if anything: folds, self-intersections, lost volume."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.self_intersections import self_intersecting
from orbiframe.surfaces.folds import Folds, folds
from orbiframe.surfaces.surface import OrbifoldSurface

_FOLD = 1e-6


class Inspection(NamedTuple):
    """The folds, as a share of the area; triangles that pass through others, (n,), in the mesh and in the
    output; the volumes within both, relative to that of the mesh, None where there is none; away: the largest distance
    of a vertex of the output to the mesh, in diagonals.
    """

    folds: Folds
    in_mesh: NDArray[np.intp]
    in_output: NDArray[np.intp]
    volume: float | None
    away: float

    @property
    def folded(self) -> float:
        """The share of the area that is folded over."""
        return self.folds.share

    def notes(self, output: Polyhedron) -> Iterator[str]:
        """Sentences for what a user should look at."""
        if self.folded > _FOLD:
            where = ", ".join(f"{x:.6g}" for x in self.folds.place)
            yield (
                f"the surface folds over on {self.folded:.1e} of its area, most near ({where}); more functions help "
                "(option size)"
            )
        if len(self.in_output) and not len(self.in_mesh):
            place = output.vertices[output.triangles[self.in_output[0]]].mean(axis=0)
            where = ", ".join(f"{x:.6g}" for x in place)
            yield (
                f"{len(self.in_output)} of {output.face_count} output triangles pass through others, one near "
                f"({where}); more functions help where parts are thin (option size)"
            )


def inspected(surface: OrbifoldSurface, output: Polyhedron, bisected: bool) -> Inspection:
    """The inspection of a surface by a mesh on it; bisected: the mesh cuts every triangle of the refined one alike."""
    fine = output if bisected else surface.tessellate(bisected=True)
    mesh = surface.own_mesh
    placed = output.with_vertices((output.vertices - surface.origin) / surface.scale)
    inside, outside = _volume(mesh), _volume(placed)
    closed = surface.triangulation.inside is None
    ratio = outside / inside if closed and not output.same.any() and abs(inside) > 0 else None
    crossing = self_intersecting(mesh), self_intersecting(output)
    away = float(NearestPoints(mesh).distance(placed.vertices).max())
    return Inspection(folds(surface, fine), *crossing, ratio, away)


def _volume(mesh: Polyhedron) -> float:
    """The volume within a triangle mesh, about the middle of its vertices."""
    corners = mesh.vertices[mesh.triangles] - mesh.vertices.mean(axis=0)
    return float(np.linalg.det(corners).sum() / 6)
