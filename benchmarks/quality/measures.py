"""Measures: how far a skin and a shape are apart, both ways, with their normals and curvature."""

from __future__ import annotations

from typing import NamedTuple

import igl
import numpy as np
from igl.copyleft import cgal
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe.meshes import triangulated
from quality.face_points import points_of_faces
from quality.foot_points import foot_points
from quality.skins import Skin
from quality.truths import Truth

Floats = NDArray[np.float64]

SAMPLES = 12_000


class Errors(NamedTuple):
    """Root mean square and largest distance in diagonals, the larger of both directions; normals in degrees; Gaussian
    curvature relative to its root mean square (NaN where no truth is known); triangles that meet others."""

    rms: float
    max: float
    normals: float
    curvature: float
    crossing: int


def errors(skin: Skin, mesh: Polyhedron, truth: Truth | None) -> Errors:
    """The errors of a surface of a mesh: against the truth, or against the faces where there is none."""
    there = _of_skin(skin)
    to = _to_faces(there, triangulated(mesh)) if truth is None else _to_truth(there, truth)
    back = _from_faces(skin, triangulated(mesh)) if truth is None else _from_truth(skin, truth)
    rms = max(_rms(to.distance, there.weights), _rms(back, np.ones(len(back))))
    largest = max(to.distance.max(), back.max())
    normals = np.degrees(_rms(to.angle, there.weights))
    crossing = -1 if truth is not None and truth.immersed else crossing_triangles(skin)
    return Errors(rms / mesh.diagonal, largest / mesh.diagonal, normals, to.curvature, crossing)


class _Samples(NamedTuple):
    points: Floats
    normals: Floats
    gaussian: Floats
    weights: Floats


class _Reached(NamedTuple):
    distance: Floats
    angle: Floats
    curvature: float


def _of_skin(skin: Skin) -> _Samples:
    """Vertices with the areas about them, at most 12,000, at random."""
    area = np.zeros(len(skin.vertices))
    a, b = np.moveaxis(np.diff(skin.vertices[skin.triangles], axis=1), 1, 0)
    np.add.at(area, skin.triangles.ravel(), np.repeat(np.linalg.norm(np.cross(a, b), axis=1), 3))
    some = np.random.default_rng(5).permutation(len(area))[:SAMPLES]
    return _Samples(skin.vertices[some], skin.normals[some], skin.gaussian[some], area[some])


def _to_truth(samples: _Samples, truth: Truth) -> _Reached:
    feet = truth.feet(samples.points)
    distance = np.linalg.norm(samples.points - feet.points, axis=1)
    if truth.immersed:
        feet = truth.feet(samples.points, samples.normals)
    share = _rms(samples.gaussian - feet.gaussian, samples.weights) / _rms(feet.gaussian, samples.weights)
    return _Reached(distance, _angles(samples.normals, feet.normals), share)


def _to_faces(samples: _Samples, mesh: Polyhedron) -> _Reached:
    corners = mesh.triangles.astype(np.int64)
    square, face, _ = igl.point_mesh_squared_distance(samples.points, mesh.vertices, corners)
    normals = np.cross(*np.moveaxis(np.diff(mesh.vertices[corners[face]], axis=1), 1, 0))
    size = np.linalg.norm(normals, axis=1, keepdims=True)
    return _Reached(np.sqrt(square), _angles(samples.normals, normals / np.where(size > 0, size, 1)), float("nan"))


def _from_truth(skin: Skin, truth: Truth) -> Floats:
    """Along the normals where the surface is near, for the foot point is exact along them to a higher order."""
    x = truth.samples[np.random.default_rng(5).permutation(len(truth.samples))[:SAMPLES]]
    foot = foot_points(skin, x)
    corners = skin.triangles[foot.face]
    gap = x - foot.points
    along = np.einsum("ni,nci->nc", gap, skin.normals[corners])
    near = np.sqrt(np.einsum("nc,nc->n", foot.barycentric, along**2))
    far = np.linalg.norm(gap, axis=1)
    side = np.linalg.norm(np.diff(skin.vertices[corners], axis=1), axis=2).max(axis=1)
    return np.where(far < side / 2, near, far)


def _from_faces(skin: Skin, mesh: Polyhedron) -> Floats:
    x = np.concatenate([mesh.vertices, points_of_faces(mesh.vertices, mesh.triangles, SAMPLES)[1]])
    return np.sqrt(igl.point_mesh_squared_distance(x, skin.vertices, skin.triangles.astype(np.int64))[0])


def crossing_triangles(skin: Skin) -> int:
    """How many triangles meet others than their neighbours."""
    pairs = cgal.remesh_self_intersections(skin.vertices, skin.triangles.astype(np.int64), detect_only=True)[2]
    return len(np.unique(pairs))


def _angles(a: Floats, b: Floats) -> Floats:
    """Angles between lines (n,), in radians."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.abs((a * b).sum(axis=1)))


def _rms(x: Floats, weights: Floats) -> float:
    return float(np.sqrt(weights @ x**2 / weights.sum()))
