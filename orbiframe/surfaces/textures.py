"""Texture coordinates: a surface cut open and laid into the unit square."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from orbiframe.errors import UsageError
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.subdivision import grid_of
from orbiframe.surfaces.meridians import meridians_and_parallels
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.triangulations.cut_open import unrolled
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# How far the coordinates of the edges of a cut lie apart at least, if both sides of it are the same place.
_APART = 1e-9


class TextureDistortion(NamedTuple):
    """How texture coordinates distort a mesh.

    angle: (F,), the ratio of the singular values of the linear map of every triangle to the square, 1 is conformal;
    area: (F,), area in the square over area in space, 1 in the mean over space; cut: number of edges on whose sides the
    coordinates differ; folded: number of other edges that have both of their triangles on one side.
    """

    angle: Floats
    area: Floats
    cut: int
    folded: int


def texture_coordinates(surface: OrbifoldSurface, density: int = 1, *, bisected: bool = False) -> Floats:
    """A point of the unit square for every corner of `surface.tessellate(density, bisected=bisected)`, (H, 2).

    X/H is cut open along edges, see `unrolled`, and drawn as everywhere: the plane E^2 as it is, H^2 in the conformal
    disc, the projective plane by equal areas about the middle. The sphere has meridians and parallels, first coordinate
    and second, from one end of the surface in space to the other; its first coordinate goes a little beyond 1 at the
    cut, so that a texture that repeats has no seam. A mesh with a boundary that is mapped to a part of the sphere is
    drawn by equal areas, seen from where it is not. Raises UsageError where the triangles of the input were flipped
    for the map, and no density of the refined mesh is asked for.
    """
    triangulation = surface.triangulation
    face, barycentric = _corners(surface, density, bisected)
    placement = unrolled(triangulation, None if bisected else _input_triangles(surface)).placement
    geometry = triangulation.orbifold.geometry
    x = geometry.project(np.einsum("nc,nci->ni", barycentric, triangulation.lifts[face]))
    x = np.einsum("nij,nj->ni", placement[face], x)
    if triangulation.orbifold.euler_characteristic == 2 and triangulation.inside is not None:
        opposite = geometry.carry(-_farthest_outside(triangulation, placement))
        uv = _into_square(_drawn(geometry.curvature, geometry.act(geometry.inverse(opposite), x)))
    elif triangulation.orbifold.euler_characteristic == 2:
        places = np.einsum("nc,nci->ni", barycentric, _in_space(triangulation)[face])
        shape = (-1, 3, 3)
        poles = _ends(triangulation, placement)
        uv = meridians_and_parallels(geometry, x.reshape(shape), places.reshape(shape), poles).reshape(-1, 2)
    else:
        uv = _into_square(_drawn(geometry.curvature, x))
    return _unmirrored(uv) if triangulation.orbifold.orientable else uv


def texture_distortion(mesh: Polyhedron) -> TextureDistortion:
    """How the texture coordinates of a triangle mesh distort it. Raises UsageError for a mesh without any."""
    if mesh.corner_uv is None:
        raise UsageError("this mesh has no texture coordinates; make some by texture_coordinates(surface)")
    corners, flat = mesh.vertices[mesh.triangles], mesh.corner_uv.reshape(-1, 3, 2)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    along = np.linalg.norm(u, axis=1)
    with np.errstate(all="ignore"):
        across = np.linalg.norm(np.cross(u, v), axis=1) / along
        first = (flat[:, 1] - flat[:, 0]) / along[:, None]
        second = (flat[:, 2] - flat[:, 0] - (np.einsum("fi,fi->f", u, v) / along)[:, None] * first) / across[:, None]
        area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        half = (first**2 + second**2).sum(axis=1) / (2 * np.abs(area))
        angle = np.where(np.isfinite(half), half + np.sqrt(np.maximum(half**2 - 1, 0)), np.inf)
    space = along * across
    mean = float((np.abs(area) * space)[np.isfinite(area)].sum() / space.sum())
    cut, whole = _edges(mesh, mesh.corner_uv)
    sides = np.sign(area)[mesh.face[whole]] * np.sign(area)[mesh.face[mesh.twin[whole]]]
    folded = ~(sides * np.where(mesh.same[whole], -1, 1) > 0)
    return TextureDistortion(angle, np.abs(area) / mean, len(cut), int(folded.sum()))


def _edges(mesh: Polyhedron, uv: Floats) -> tuple[Ints, Ints]:
    """The edges on whose sides the coordinates differ, and the others, as halfedges."""
    h = np.flatnonzero(mesh.representative & (mesh.twin >= 0))
    twin, same = mesh.twin[h], mesh.same[h]
    tails, heads = (np.where(same, a, b) for a, b in ((twin, mesh.next[twin]), (mesh.next[twin], twin)))
    apart = np.abs(np.concatenate([uv[h] - uv[tails], uv[mesh.next[h]] - uv[heads]], axis=1)).max(axis=1)
    return h[apart > _APART], h[apart <= _APART]


def _corners(surface: OrbifoldSurface, density: int, bisected: bool) -> tuple[Ints, Floats]:
    """The place of every corner of a tessellation in a triangle of the map, the same side of a cut for each face."""
    faces = (surface.triangulation.polyhedron if bisected else surface.refinement.coarse).face_count
    face = np.repeat(np.arange(faces), 3 * density**2)
    barycentric = np.tile(grid_of(density).reshape(-1, 3), (faces, 1))
    inside = surface.triangulation.inside
    if inside is not None:
        own = np.repeat(inside if bisected else surface.own, 3 * density**2)
        face, barycentric = face[own], barycentric[own]
    if bisected:
        return face, barycentric
    log = surface.refinement.log
    if log is not None and len(log.halfedge):
        raise UsageError(
            "triangles of the input were flipped or halved for the map, and texture coordinates follow those of the "
            "map; leave --refine (output.refine) out"
        )
    return surface.refinement.locate(face, barycentric)


def _input_triangles(surface: OrbifoldSurface) -> Ints:
    """The triangle of the input in which each triangle of the map lies, (F,)."""
    count = surface.refinement.coarse.face_count
    roots = np.repeat(np.arange(count, dtype=np.float64), 3).reshape(count, 3, 1)
    return np.rint(surface.refinement.spread(roots)[:, 0, 0]).astype(np.intp)


def _in_space(triangulation: Triangulation) -> Floats:
    return np.asarray(triangulation.polyhedron.vertices[triangulation.polyhedron.triangles])


def _farthest_outside(triangulation: Triangulation, placement: Floats) -> Floats:
    """The point of S^2 in the midst of a triangle beyond the boundary, as far as possible from those within it."""
    centres = triangulation.orbifold.geometry.project(triangulation.lifts.sum(axis=1))
    centres = np.einsum("fij,fj->fi", placement, centres)
    assert triangulation.inside is not None
    beyond = centres[~triangulation.inside]
    away = cKDTree(centres[triangulation.inside]).query(beyond)[0]
    return np.asarray(beyond[np.argmax(away)])


def _ends(triangulation: Triangulation, placement: Floats) -> Floats:
    """The two vertices, (2, 3) in the frame of the unrolled triangles, that lie at the ends of the mesh in space."""
    mesh = triangulation.polyhedron
    centred = mesh.vertices - mesh.vertices.mean(axis=0)
    along = centred @ np.linalg.svd(centred, full_matrices=False)[2][0]
    first = np.unique(mesh.tail, return_index=True)[1]
    corner = first[np.searchsorted(mesh.tail[first], [int(along.argmin()), int(along.argmax())])]
    found = np.einsum("kij,kj->ki", placement[corner // 3], triangulation.lifts.reshape(-1, 3)[corner])
    return np.asarray(found)


def _unmirrored(uv: Floats) -> Floats:
    """The same coordinates, or those of their mirror image if most triangles are turned over."""
    a, b, c = (uv[k::3] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    return uv if area.sum() >= 0 else np.stack([1 - uv[:, 0], uv[:, 1]], axis=1)


def _drawn(curvature: int, x: Floats) -> Floats:
    """Points of X in the plane: E^2 as it is, H^2 in the conformal disc, S^2 by equal areas about the origin."""
    if curvature == 0:
        return _along_its_axis(x[:, 1:])
    if curvature < 0:
        return np.asarray(x[:, 1:] / (1 + x[:, :1]))
    return np.asarray(x[:, 1:] * np.sqrt(2 / np.maximum(1 + x[:, :1], np.finfo(float).eps)))


def _along_its_axis(points: Floats) -> Floats:
    """The points (n, 2) turned so that their cloud lies along the first coordinate."""
    centred = points - points.mean(axis=0)
    x, y = np.linalg.svd(centred, full_matrices=False)[2][0]
    return np.asarray(centred @ np.array([[x, -y], [y, x]]))


def _into_square(points: Floats) -> Floats:
    """The points moved and scaled until they touch the sides of the unit square; circles stay circles."""
    low, high = points.min(axis=0), points.max(axis=0)
    return np.asarray(0.5 + (points - (low + high) / 2) / float((high - low).max()))
