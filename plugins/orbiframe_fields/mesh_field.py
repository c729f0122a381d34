"""Mesh field: the fields of data on the surfaces of a mesh, evaluated on a mesh."""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError, OrbifoldSurface, Points, Polyhedron, Registry, UsageError, load_surface, read
from orbiframe.surfaces import Field, fit_field, nearest_points
from orbiframe_fields.field_data import FieldData, read_data
from orbiframe_fields.field_table import FieldTable
from orbiframe_fields.fitted_surfaces import fitted_surfaces

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

SURFACE = ".npz"
_FITTER, _ROBUST = "smoothing", "robust"
_OUTPUT_FACES = 40_000
# For data that are to be met, two functions for each of them.
_FUNCTIONS_PER_DATUM = 2


@dataclass(frozen=True, eq=False)
class MeshField:
    """The fields on the surfaces of a mesh.

    mesh: as given; vertices: for each surface the numbers of its vertices in the mesh; fields: one on each surface;
    data: what they were fitted to; owned: for each surface the numbers of its data.
    """

    mesh: Polyhedron
    vertices: list[Ints]
    fields: list[Field]
    data: FieldData
    owned: list[Ints]

    @property
    def count(self) -> int:
        """How many data there are."""
        return len(self.data.places)

    @property
    def distance(self) -> float:
        """How far a datum is from the surface at most."""
        return max(float(field.distance.max()) for field in self.fields)

    @property
    def outliers(self) -> list[int] | None:
        """The numbers of the data that are far off; None where the fitter does not look for them."""
        marked = [(own, field.outliers) for own, field in zip(self.owned, self.fields, strict=True)]
        known = [own[outliers] for own, outliers in marked if outliers is not None]
        return sorted(np.concatenate(known).tolist()) if known else None

    def described(self) -> Iterator[tuple[str, float, float, float, float]]:
        """Of each column of numbers its name, its range in the data, the error at a datum left out, and the noise."""
        each = [(len(own), field) for own, field in zip(self.owned, self.fields, strict=True)]
        error, noise = (_mean_square([(n, getattr(field, name)) for n, field in each]) for name in ("error", "noise"))
        low, high = self.data.table.min(axis=0), self.data.table.max(axis=0)
        told = FieldTable(self.mesh, self.data.unpacked(np.stack([error, noise]))).scalars
        for k, (name, values) in enumerate(told.items()):
            yield name, float(low[k]), float(high[k]), float(values[0]), float(values[1])

    def table(self, refine: int | None, *, error_bars: bool = False) -> FieldTable:
        """The fields on a mesh: fine, or every triangle in refine^2, or for 0 at the vertices of the mesh itself.

        error_bars: with their standard errors, after whose names stands _error.
        """
        if refine == 0:
            return FieldTable(self.mesh, self._columns(self._at_vertices(error_bars)))
        meshes, values = [], []
        for field in self.fields:
            mesh, points = tessellated(field.surface, refine, len(self.fields))
            meshes.append(mesh)
            values.append(_told(field, points, error_bars))
        normals = np.concatenate([mesh.normals for mesh in meshes if mesh.normals is not None])
        return FieldTable(side_by_side(meshes), {"normal": normals, **self._columns(np.concatenate(values, axis=1))})

    def _columns(self, told: Floats) -> dict[str, Floats]:
        """The columns of values, and of their errors if there are some, (1 or 2, n, q)."""
        values, *errors = told
        marked = {f"{name}_error": each for part in errors for name, each in self.data.unpacked(part).items()}
        return self.data.unpacked(values) | marked

    def _at_vertices(self, error_bars: bool) -> Floats:
        values = np.full((1 + error_bars, len(self.mesh.vertices), self.data.table.shape[1]), np.nan)
        for vertices, field in zip(self.vertices, self.fields, strict=True):
            feet = nearest_points(field.surface, self.mesh.vertices[vertices])[0]
            values[:, vertices] = _told(field, feet, error_bars)
        return values


def _told(field: Field, points: Points, error_bars: bool) -> Floats:
    """The values over points, and their standard errors if wanted, (1 or 2, n, q)."""
    return np.stack([field.evaluate(points), *([field.standard_error(points)] if error_bars else [])])


def _mean_square(parts: list[tuple[int, Floats | None]]) -> Floats:
    """The root mean square (q,) of numbers that each stand for so many data."""
    known = [(count, values) for count, values in parts if values is not None]
    return np.asarray(np.sqrt(sum(n * v**2 for n, v in known) / sum(n for n, _ in known)))


def mesh_field(args: argparse.Namespace, registry: Registry) -> MeshField:
    """The fields of the data of a command line, each datum on the surface that is nearest to it."""
    fitter = _fitter(args, registry)
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
    shared = list(_shared(surfaces, data.places))
    fields = [_field(*each, data, fitter) for each in shared]
    args.progress("field", time.perf_counter() - start)
    return MeshField(mesh, vertices, fields, data, [own for *_, own in shared])


def _fitter(args: argparse.Namespace, registry: Registry) -> Any:
    """The one that the options ask for."""
    if args.robust:
        return registry.load("fitter", _ROBUST)(fairing=args.fairing, loss=args.robust)
    if args.interpolate and args.fairing is not None:
        raise UsageError("--interpolate meets the data and smooths nothing; leave out --fairing")
    return registry.load("fitter", _FITTER)(fairing=args.fairing, interpolate=args.interpolate)


def _shared(surfaces: list[OrbifoldSurface], places: Floats) -> Iterator[tuple[OrbifoldSurface, Points, Floats, Ints]]:
    """For each surface the data that are nearest to it: their points, distances and numbers."""
    found = [nearest_points(surface, places) for surface in surfaces]
    nearest = np.argmin([distance for _, distance in found], axis=0)
    for k, (surface, (points, distance)) in enumerate(zip(surfaces, found, strict=True)):
        own = np.flatnonzero(nearest == k)
        if not len(own):
            raise FitError(f"component {k + 1} of the mesh has no datum; give it some, or leave it out of the mesh")
        yield surface, Points(points.patch[own], points.x[own]), distance[own], own


def _field(
    surface: OrbifoldSurface, points: Points, distance: Floats, own: Ints, data: FieldData, fitter: Any
) -> Field:
    fixed = None if data.fixed is None else data.fixed[own]
    return replace(fit_field(surface, points, data.table[own], fitter=fitter, fixed=fixed), distance=distance)


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
