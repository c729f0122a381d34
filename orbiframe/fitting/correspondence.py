"""Correspondence: the map of a surface, taken over by a deformed or refined mesh of the same shape, while it serves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.registry import Registry
from orbiframe.errors import MapError
from orbiframe.files.surface_file import load_surface_map
from orbiframe.fitting.same_triangles import cut_like, glued_alike
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.edge_log import EdgeLog
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.submesh import submesh
from orbiframe.meshes.surface_type import surface_type
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.triangulations.carried_map import carried
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]

# A vertex of a mesh that is cut otherwise may be so far from the old mesh, of the diagonal of its box.
_FAR = 0.05
# The ratio of angles that 5 % of the area exceed: from where on a user should hear of it, and from where on the map
# serves no more. In between fits are good, as trials on twisted, stretched and bent meshes show: decision 42.
_TOLD, _MOST = 4.0, 20.0
_NEAR = 1e-6
_BENT = 1e-12


class Carried(NamedTuple):
    """A map that was taken over: whether the triangles are the old ones, and the largest distance to the old mesh."""

    refinement: Bisection
    triangulation: Triangulation
    same: bool
    distance: float | None


@dataclass(frozen=True, eq=False)
class Correspondence:
    """The map of a refined mesh of unit size to X/H, where and how large that mesh is in space, and its name.

    size: the number of functions that creases were placed for, where there are some.
    """

    triangulation: Triangulation
    refinement: Bisection
    origin: Floats
    scale: float
    size: int | None
    name: str

    @classmethod
    def of_file(cls, path: Path, registry: Registry) -> Correspondence:
        """That of a saved surface. Raises FormatError for what is none."""
        return cls(*load_surface_map(path, registry), path.name)

    @classmethod
    def of_surface(cls, surface: OrbifoldSurface, name: str = "the surface") -> Correspondence:
        """That of a surface."""
        size = surface.basis_options.get("size")
        return cls(surface.triangulation, surface.refinement, surface.origin, surface.scale, size, name)

    def creased(self, mapped: Triangulation, sharp: NDArray[np.bool_], size: int) -> Triangulation | None:
        """The map of the same triangles with the creases and sites of the old one; None where they are others."""
        crease, seam, sites = self.triangulation.crease, self.triangulation.seam, self.triangulation.sites
        if crease is None or size != self.size or mapped.points is not self.triangulation.points:
            return None
        return replace(mapped, crease=crease, seam=seam, sites=sites) if np.array_equal(crease, sharp) else None

    @cached_property
    def own_mesh(self) -> Polyhedron:
        """The triangles of the old mesh, without those that only close it."""
        inside = self.triangulation.inside
        return self.refinement.coarse if inside is None else submesh(self.refinement.coarse, self.own).mesh

    @property
    def own(self) -> NDArray[np.bool_]:
        """Which of the triangles of the old mesh do not only close it, (F,)."""
        coarse, inside = self.refinement.coarse, self.triangulation.inside
        facets = self.refinement.in_facets()[: coarse.face_count]
        return np.ones(coarse.face_count, dtype=np.bool_) if inside is None else np.asarray(inside[facets])

    def cut(self, mesh: Polyhedron) -> Polyhedron:
        """The mesh, in triangles where its faces are those of the old mesh and would be cut otherwise than they were.

        Raises MapError for a mesh that is another surface than the old one.
        """
        self._require_alike(mesh)
        return cut_like(mesh, self.own_mesh)

    def closed(self, triangles: Polyhedron) -> tuple[Polyhedron, NDArray[np.bool_]]:
        """The triangles of a mesh with a boundary, closed as those of the old mesh were, and which are its own.

        What closes them moves with the boundary beside it. Raises MapError where they are not those of the old mesh.
        """
        coarse = self.refinement.coarse
        if not glued_alike(triangles, self.own_mesh):
            raise self._no_use(
                f"a mesh with a boundary needs the {self.own_mesh.face_count} triangles of the old one, only moved, "
                f"and this one has {triangles.face_count}, or others"
            )
        vertices, count = coarse.vertices.copy(), len(triangles.vertices)
        rim = np.unique(triangles.tail[triangles.twin < 0])
        apart = np.linalg.norm(vertices[count:, None] - vertices[None, rim], axis=2)
        moved = triangles.vertices - vertices[:count]
        vertices[count:] += moved[rim[apart.argmin(axis=1)]]
        vertices[:count] = triangles.vertices
        return coarse.with_vertices(vertices), self.own

    @property
    def _plain(self) -> Triangulation:
        """The map without creases."""
        return replace(self.triangulation, crease=None, seam=None, sites=None)

    def serves(self, triangles: Polyhedron, least: int) -> bool:
        """Whether triangles are the old ones, and refined to about so many vertices at least."""
        enough = 2 * len(self.refinement.polyhedron.vertices) >= least
        return enough and glued_alike(triangles, self.refinement.coarse)

    def moved(self, triangles: Polyhedron) -> Carried:
        """The map of the old triangles with their vertices moved: the same in X/H."""
        old, log = self.refinement, self.refinement.log
        steps = None if log is None else EdgeLog(triangles, log.halfedge, log.crossing, log.halved)
        fine = old.polyhedron.with_vertices(_fine_vertices(old, triangles, steps))
        refinement = Bisection(triangles, fine, old.side, old.child, steps)
        return self._verified(Carried(refinement, replace(self._plain, polyhedron=fine), True, None))

    def refined(self, refinement: Bisection, origin: Floats, scale: float) -> Carried:
        """The map of a mesh that is cut otherwise, with the vertices of its refinement where they are nearest."""
        if self.triangulation.inside is not None:
            raise self._no_use("a mesh with a boundary needs the triangles of the old one, as fine as they were")
        old, fine = self.refinement.polyhedron, refinement.polyhedron
        if glued_alike(refinement.coarse, self.refinement.coarse):
            face, barycentric = self.refinement.locate(*refinement.origins())
            distance = None
        else:
            placed = (origin + scale * fine.vertices - self.origin) / self.scale
            face, barycentric = NearestPoints(old).places(placed)
            there = np.einsum("nc,nci->ni", barycentric, old.vertices[old.triangles[face]])
            distance = float(np.linalg.norm(there - placed, axis=1).max())
            if distance > _FAR:
                raise self._no_use(
                    f"its triangles are not those of the old mesh, and a vertex is {distance:.2g} of the diagonal away "
                    f"from it, at most {_FAR:g} is near"
                )
        try:
            found = carried(self._plain, fine, face, barycentric)
        except MapError as error:
            raise self._no_use(f"it is not beside the old mesh in one piece: {error}") from error
        return self._verified(Carried(refinement, found, False, distance))

    def distortion(self, triangulation: Triangulation) -> float:
        """The ratio of angles that 5 % of the area of a mesh exceed in its map."""
        own = triangulation.own_faces
        weights = np.linalg.norm(vector_areas(triangulation.polyhedron), axis=1)[own]
        values = triangulation.angle_distortion[own]
        order = np.argsort(values, kind="stable")
        share = np.cumsum(weights[order]) / weights.sum()
        return float(values[order[min(int(np.searchsorted(share, 0.95)), len(order) - 1)]])

    def report(self, found: Carried) -> dict[str, Any]:
        """What was taken over, as plain data."""
        return {
            "file": self.name,
            "same_triangles": found.same,
            "distance": found.distance,
            "angle_distortion_before": self.distortion(self.triangulation),
        }

    def notes(self, triangulation: Triangulation) -> tuple[str, ...]:
        """What a user should know of a map that hardly serves."""
        now = self.distortion(triangulation)
        if now <= _TOLD:
            return ()
        return (
            f"the map of {self.name} stretches this mesh: angles by a ratio of {now:.1f} or more on 5 % of it, "
            f"{self.distortion(self.triangulation):.1f} before; a map of its own is better (leave out --like)",
        )

    def _verified(self, found: Carried) -> Carried:
        folded, count = found.triangulation.not_positive, found.triangulation.polyhedron.face_count
        if folded:
            raise self._no_use(f"{folded} of {count} triangles fold over in X/H")
        whole = found.triangulation.area_defect <= _NEAR and found.triangulation.relation_defect <= _NEAR
        if not whole:
            raise self._no_use(
                "its triangles do not cover X/H once; they jump where the old mesh passes through itself"
            )
        distortion = self.distortion(found.triangulation)
        if not distortion <= _MOST:
            raise self._no_use(
                f"angles are distorted by a ratio of {distortion:.3g} or more on 5 % of the area, {_MOST:g} is the "
                f"most ({self.distortion(self.triangulation):.1f} on the old mesh)"
            )
        return found

    def _require_alike(self, mesh: Polyhedron) -> None:
        old, new = surface_type(self.own_mesh), surface_type(mesh)
        kinds = [(each.euler_characteristic, each.orientable, each.closed) for each in (old, new)]
        if kinds[0] != kinds[1]:
            was, now = (f"Euler characteristic {each.euler_characteristic} ({each.name})" for each in (old, new))
            raise self._no_use(f"it is that of a surface of {was}, and this mesh has {now}")

    def _no_use(self, why: str) -> MapError:
        return MapError(f"the map of {self.name} does not serve this mesh: {why}; leave out --like (map.like)")


def _fine_vertices(old: Bisection, triangles: Polyhedron, log: EdgeLog | None) -> Floats:
    """The vertices of the refinement on the moved triangles.

    Halved edges give them to the last bit. Facets whose edges were flipped while they were flat may have become bent,
    and there they lie on the triangles before the flips.
    """
    facets = triangles if log is None else log.after
    fine = old.spread(facets.vertices[facets.triangles]).reshape(-1, 3)
    found = fine[np.unique(old.polyhedron.tail, return_index=True)[1]]
    face, barycentric = old.origins()
    there = np.einsum("nc,nci->ni", barycentric, triangles.vertices[triangles.triangles[face]])
    bent = np.abs(there - found).max(axis=1) > _BENT
    return np.where(bent[:, None], there, found)
