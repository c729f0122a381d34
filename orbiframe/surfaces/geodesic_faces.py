"""Geodesic faces: the triangles of X/H that elements of a surface are the images of."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.delaunay.crease_domain import crease_triangulation
from orbiframe.delaunay.site_triangulation import delaunay_of_vertices
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.submesh import submesh
from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Areas that add up to that of X/H but for this share are those of triangles without a fold; one that is smaller than
# this share of the mean is none.
_ROUNDING = 1e-7


class GeodesicFaces(NamedTuple):
    """Geodesic triangles that cover X/H, and how they are glued.

    gluing: a triangle mesh whose faces and twins are those of the triangles; where its vertices lie means nothing.
    patch: (F,) and corners: (F, 3, 3), the corners of every triangle in the frame of one patch; of_input: whether they
    are those of the input.
    """

    orbifold: Orbifold
    gluing: Polyhedron
    patch: Ints
    corners: Floats
    of_input: bool = True

    @classmethod
    def of_triangulation(cls, triangulation: GeodesicTriangulation) -> GeodesicFaces:
        """The triangles of a geodesic triangulation."""
        offsets = 3 * np.arange(triangulation.face_count + 1)
        places = np.zeros((triangulation.vertex_count, 3))
        gluing = Polyhedron(places, offsets, triangulation.vertex.ravel(), triangulation.twin, triangulation.same)
        corners = triangulation.geometry.act(triangulation.placement[:, None], triangulation.corners)
        return cls(triangulation.orbifold, gluing, triangulation.patch, corners, False)

    @property
    def areas(self) -> Floats:
        """The signed area of every triangle in the frame of its patch, (F,)."""
        return self.orbifold.geometry.triangle_area(*np.moveaxis(self.corners, 1, 0))

    @property
    def whole(self) -> bool:
        """Whether no triangle is folded over and none is degenerate: their areas add up to that of X/H."""
        area = np.abs(self.areas)
        defect = abs(float(area.sum()) / self.orbifold.area - 1)
        return defect < _ROUNDING and bool(area.min() > _ROUNDING * area.mean())

    def locate(self, face: Ints, barycentric: Floats) -> Points:
        """The points of X/H at barycentric coordinates (n, 3) in triangles (n,), by projection to X.

        Points of a side depend on its ends alone, so that the triangles on both sides agree.
        """
        x = np.einsum("nc,nci->ni", barycentric, self.corners[face])
        return Points(self.patch[face], self.orbifold.geometry.project(x))


def input_faces(surface: OrbifoldSurface) -> GeodesicFaces:
    """The geodesic triangles between the vertices of the input; where these fold, the Delaunay triangles instead.

    A triangle of the input with sides that are geodesics of X is not what the map makes of it, and may be turned over
    where the map bends much; then all triangles are those of the Delaunay triangulation with the same vertices, none of
    which is folded. On a surface with creases they are the triangles of the domain of its functions, as creases are
    edges of that. Those of a surface with a boundary are only its own, and where they
    would fold those of the refined mesh.
    """
    if surface.triangulation.crease is not None:
        return GeodesicFaces.of_triangulation(crease_triangulation(surface.triangulation))
    coarse, flat = surface.refinement.coarse, surface.triangulation
    geometry, atlas = surface.orbifold.geometry, surface.orbifold.atlas
    step = surface.refinement.composed(atlas.isometry[flat.transition]).reshape(-1, 3, 3, 3)
    x = flat.points[coarse.triangles]
    second, third = geometry.act(step[:, 0], x[:, 1]), geometry.act(geometry.inverse(step[:, 2]), x[:, 2])
    corners = np.stack([x[:, 0], second, third], axis=1)
    faces = GeodesicFaces(surface.orbifold, coarse, flat.patch[coarse.triangles[:, 0]], corners)
    if flat.inside is None:
        return faces if faces.whole else GeodesicFaces.of_triangulation(_delaunay(surface))
    if faces.whole:
        own = np.flatnonzero(surface.own)
        return GeodesicFaces(surface.orbifold, surface.own_mesh, faces.patch[own], corners[own])
    gluing, own = submesh(flat.polyhedron, flat.inside).mesh, flat.own_faces
    first = flat.patch[flat.polyhedron.triangles[own, 0]]
    return GeodesicFaces(surface.orbifold, gluing, first, flat.lifts[own], False)


def _delaunay(surface: OrbifoldSurface) -> GeodesicTriangulation:
    """The Delaunay triangulation of X/H with the vertices of the input."""
    start = GeodesicTriangulation.of_map(surface.triangulation)
    number = np.empty(len(surface.triangulation.polyhedron.vertices), dtype=np.intp)
    number[surface.triangulation.polyhedron.triangles] = start.vertex
    return delaunay_of_vertices(start, number[: len(surface.refinement.coarse.vertices)]).triangulation
