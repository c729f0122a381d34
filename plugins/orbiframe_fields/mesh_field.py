"""Mesh field: the fields of data on the surfaces of a mesh, evaluated on a mesh."""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError, OrbifoldSurface, Points, Polyhedron, Registry, load_surface, read
from orbiframe.surfaces import Field, fit_field, nearest_points
from orbiframe_fields.field_data import FieldData, read_data
from orbiframe_fields.field_table import FieldTable
from orbiframe_fields.fitted_surfaces import fitted_surfaces

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

SURFACE = ".npz"
_FITTER = "smoothing"
_OUTPUT_FACES = 40_000
# For data that are to be met, two functions for each of them.
_FUNCTIONS_PER_DATUM = 2


@dataclass(frozen=True, eq=False)
class MeshField:
    """The fields on the surfaces of a mesh.

    mesh: as given; vertices: for each surface the numbers of its vertices in the mesh; fields: one on each surface;
    data: what they were fitted to.
    """

    mesh: Polyhedron
    vertices: list[Ints]
    fields: list[Field]
    data: FieldData

    @property
    def count(self) -> int:
        """How many data there are."""
        return len(self.data.places)

    @property
    def distance(self) -> float:
        """How far a datum is from the surface at most."""
        return max(float(field.distance.max()) for field in self.fields)

    def described(self) -> Iterator[tuple[str, float, float, float]]:
        """Of each column of numbers its name, its range in the data, and the error at a datum that is left out."""
        left_out = np.concatenate([field.left_out for field in self.fields if field.left_out is not None])
        error = np.sqrt(np.nanmean(left_out**2, axis=0))[None]
        low, high = self.data.table.min(axis=0), self.data.table.max(axis=0)
        errors = FieldTable(self.mesh, self.data.unpacked(error)).scalars
        for k, (name, values) in enumerate(errors.items()):
            yield name, float(low[k]), float(high[k]), float(values[0])

    def table(self, refine: int | None) -> FieldTable:
        """The fields on a mesh: fine, or every triangle in refine^2, or for 0 at the vertices of the mesh itself."""
        if refine == 0:
            return FieldTable(self.mesh, self.data.unpacked(self._at_vertices()))
        meshes, values = [], []
        for field in self.fields:
            mesh, points = tessellated(field.surface, refine, len(self.fields))
            meshes.append(mesh)
            values.append(field.evaluate(points))
        normals = np.concatenate([mesh.normals for mesh in meshes if mesh.normals is not None])
        return FieldTable(side_by_side(meshes), {"normal": normals, **self.data.unpacked(np.concatenate(values))})

    def _at_vertices(self) -> Floats:
        values = np.full((len(self.mesh.vertices), self.data.table.shape[1]), np.nan)
        for vertices, field in zip(self.vertices, self.fields, strict=True):
            feet = nearest_points(field.surface, self.mesh.vertices[vertices])[0]
            values[vertices] = field.evaluate(feet)
        return values


def mesh_field(args: argparse.Namespace, registry: Registry) -> MeshField:
    """The fields of the data of a command line, each datum on the surface that is nearest to it."""
    fitter = registry.load("fitter", _FITTER)(fairing=args.fairing)
    saved = args.mesh.suffix.lower() == SURFACE
    if saved:
        surfaces = [load_surface(args.mesh, registry)]
        mesh = vertices_of(surfaces[0])
        vertices = [np.arange(len(mesh.vertices))]
        data = read_data(args.data, mesh, args.value)
    else:
        mesh = read(args.mesh, registry)
        data = read_data(args.data, mesh, args.value)
        least = _FUNCTIONS_PER_DATUM * len(data.places)
        options = [*args.set, *([] if args.boundary is None else [f"mesh.boundary={args.boundary}"])]
        fitted = fitted_surfaces(mesh, args.config, options, registry, args.progress, least=least)
        surfaces, vertices = [each.surface for each in fitted], [each.vertices for each in fitted]
    args.progress("field", None)
    start = time.perf_counter()
    fields = [_field(*each, data.table, fitter) for each in _shared(surfaces, data.places)]
    args.progress("field", time.perf_counter() - start)
    return MeshField(mesh, vertices, fields, data)


def _shared(surfaces: list[OrbifoldSurface], places: Floats) -> Iterator[tuple[OrbifoldSurface, Points, Floats, Ints]]:
    """For each surface the data that are nearest to it: their points, distances and numbers."""
    found = [nearest_points(surface, places) for surface in surfaces]
    nearest = np.argmin([distance for _, distance in found], axis=0)
    for k, (surface, (points, distance)) in enumerate(zip(surfaces, found, strict=True)):
        own = np.flatnonzero(nearest == k)
        if not len(own):
            raise FitError(f"component {k + 1} of the mesh has no datum; give it some, or leave it out of the mesh")
        yield surface, Points(points.patch[own], points.x[own]), distance[own], own


def _field(surface: OrbifoldSurface, points: Points, distance: Floats, own: Ints, table: Floats, fitter: Any) -> Field:
    from dataclasses import replace

    return replace(fit_field(surface, points, table[own], fitter=fitter), distance=distance)


def vertices_of(surface: OrbifoldSurface) -> Polyhedron:
    """The mesh of a saved surface, its triangles, in space."""
    coarse = surface.own_mesh
    return coarse.with_vertices(surface.origin + surface.scale * coarse.vertices)


def tessellated(surface: OrbifoldSurface, refine: int | None, parts: int) -> tuple[Polyhedron, Points]:
    """Every triangle of the input cut alike, or the refined mesh cut so that it has about as many faces as wanted."""
    if refine is not None:
        return surface.tessellation(refine)
    faces = len(surface.triangulation.own_faces)
    return surface.tessellation(max(1, round(math.sqrt(_OUTPUT_FACES / parts / faces))), bisected=True)


def side_by_side(meshes: list[Polyhedron]) -> Polyhedron:
    """One mesh of all."""
    begin = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    corners = np.concatenate([mesh.tail + first for mesh, first in zip(meshes, begin, strict=False)])
    sizes = np.concatenate([mesh.face_sizes for mesh in meshes])
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    return Polyhedron.from_corners(np.concatenate([mesh.vertices for mesh in meshes]), offsets, corners)
