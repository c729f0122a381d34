"""Folds: the share of a surface whose triangles are turned over, however fine they are, and where."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.subdivision import refine
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_FINE = 24
_FACES = 512  # of the bisected mesh, that are cut at one time
# Normals at the corners of a triangle are taken so far inside of it: beyond a crease they are others.
_INSIDE = 1e-6


class Folds(NamedTuple):
    """The share of the area of a surface that is folded over, and a point in space where most of it is."""

    share: float
    place: tuple[float, float, float]


def folded_share(surface: OrbifoldSurface, fine: Polyhedron) -> float:
    """The share of the area of a surface that is folded over; see `folds`."""
    return folds(surface, fine).share


def folds(surface: OrbifoldSurface, fine: Polyhedron) -> Folds:
    """The area of the triangles that face against the normals of the surface, over that of all.

    fine: a mesh on the surface with normals, each face of the bisected mesh cut in as many triangles as any other. The
    faces with a turned one are cut in 576: a rim that bends within one triangle vanishes then, and a fold keeps its
    area. 0 for functions without derivatives.
    """
    if fine.normals is None:
        return Folds(0.0, (0.0, 0.0, 0.0))
    a, b, c = np.moveaxis(((fine.vertices - surface.origin) / surface.scale)[fine.triangles], 1, 0)
    vector = np.cross(b - a, c - a)
    corners = fine.normals[fine.triangles] if fine.corner_normals is None else fine.corner_normals.reshape(-1, 3, 3)
    against = np.einsum("fi,fi->f", vector, corners.sum(axis=1)) < 0
    own = surface.triangulation.own_faces
    turned = against.reshape(len(own), -1).any(axis=1)
    flagged = own[turned]
    parts = [_turned_areas(surface, flagged[start : start + _FACES]) for start in range(0, len(flagged), _FACES)]
    areas = np.concatenate([*parts, np.zeros(1)])
    worst = int(areas.argmax())
    middle = fine.vertices[fine.triangles].reshape(len(own), -1, 3)[turned].mean(axis=1)
    place = middle[worst] if areas[worst] > 0 else np.zeros(3)
    x, y, z = (float(number) for number in place)
    return Folds(float(2 * areas.sum() / np.linalg.norm(vector, axis=1).sum()), (x, y, z))


def _turned_areas(surface: OrbifoldSurface, faces: Ints) -> Floats:
    """The turned areas, before they are scaled, of some faces of the bisected mesh, cut in 576 triangles each."""
    assert isinstance(surface.basis, DifferentiableBasis)
    triangulation, (barycentric, triangles) = surface.triangulation, _grid(_FINE)
    count, each = len(faces), len(barycentric)
    places = np.repeat(faces, each), np.tile(barycentric, (count, 1))
    inside = (1 - _INSIDE) * places[1] + _INSIDE / 3
    values = surface.basis.values(triangulation.locate(*places), surface.coefficients)
    jets = surface.basis.jets(triangulation.locate(places[0], inside), surface.coefficients, 1)
    normal = np.cross(jets[1], jets[2]) * triangulation.face_signs[np.repeat(faces, each), None]
    a, b, c = np.moveaxis(values.reshape(count, each, 3)[:, triangles], 2, 0)
    vector = np.cross(b - a, c - a)
    against = np.einsum("fti,fti->ft", vector, normal.reshape(count, each, 3)[:, triangles].sum(axis=2)) < 0
    return np.asarray((np.linalg.norm(vector, axis=2) * against).sum(axis=1) / 2)


def _grid(density: int) -> tuple[Floats, Ints]:
    """Barycentric coordinates of the points of one triangle cut in density^2, and its triangles."""
    one = refine(Polyhedron.from_faces(np.eye(3), np.array([[0, 1, 2]])), density)
    return one.barycentric, one.polyhedron.triangles
