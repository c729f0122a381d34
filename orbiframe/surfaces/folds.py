"""Folds: the share of a surface whose triangles are turned over, however fine they are."""

from __future__ import annotations

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


def folded_share(surface: OrbifoldSurface, fine: Polyhedron) -> float:
    """The area of the triangles that face against the normals of the surface, over that of all.

    fine: a mesh on the surface with normals, each face of the bisected mesh cut in as many triangles as any other. The
    faces with a turned one are cut in 576: a rim that bends within one triangle vanishes then, and a fold keeps its
    area. 0 for functions without derivatives.
    """
    if fine.normals is None:
        return 0.0
    a, b, c = np.moveaxis(((fine.vertices - surface.origin) / surface.scale)[fine.triangles], 1, 0)
    vector = np.cross(b - a, c - a)
    against = np.einsum("fi,fi->f", vector, fine.normals[fine.triangles].sum(axis=1)) < 0
    own = surface.triangulation.own_faces
    flagged = own[against.reshape(len(own), -1).any(axis=1)]
    parts = [_turned_area(surface, flagged[start : start + _FACES]) for start in range(0, len(flagged), _FACES)]
    return float(2 * sum(parts) / np.linalg.norm(vector, axis=1).sum())


def _turned_area(surface: OrbifoldSurface, faces: Ints) -> float:
    """The turned area, before it is scaled, of some faces of the bisected mesh, cut in 576 triangles each."""
    assert isinstance(surface.basis, DifferentiableBasis)
    triangulation, (barycentric, triangles) = surface.triangulation, _grid(_FINE)
    count, each = len(faces), len(barycentric)
    points = triangulation.locate(np.repeat(faces, each), np.tile(barycentric, (count, 1)))
    jets = surface.basis.jets(points, surface.coefficients, 1)
    normal = np.cross(jets[1], jets[2]) * triangulation.face_signs[np.repeat(faces, each), None]
    a, b, c = np.moveaxis(jets[0].reshape(count, each, 3)[:, triangles], 2, 0)
    vector = np.cross(b - a, c - a)
    against = np.einsum("fti,fti->ft", vector, normal.reshape(count, each, 3)[:, triangles].sum(axis=2)) < 0
    return float((np.linalg.norm(vector, axis=2) * against).sum() / 2)


def _grid(density: int) -> tuple[Floats, Ints]:
    """Barycentric coordinates of the points of one triangle cut in density^2, and its triangles."""
    one = refine(Polyhedron.from_faces(np.eye(3), np.array([[0, 1, 2]])), density)
    return one.barycentric, one.polyhedron.triangles
