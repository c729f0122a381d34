"""Surface laws: what the arrays of a surface file are to one another, checked before anything is computed from them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.delaunay.crease_domain import crease_triangulation, off_geodesics
from orbiframe.errors import OrbiframeError
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.edge_log import EdgeLog
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.surface_type import surface_type
from orbiframe.orbifolds.atlas import Atlas
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Arrays = Mapping[str, NDArray[Any]]

# Far above what rounding costs in the worst of maps, and far below what another surface would show.
_NEAR, _ROUGHLY = 1e-6, 1e-3
_DEEPEST = 500


class BrokenLaw(Exception):
    """An array of a surface file, and the law that it breaks, in words."""

    def __init__(self, array: str, law: str) -> None:
        super().__init__(f"the array '{array}' breaks a law: {law}")


def require(holds: Any, array: str, law: str) -> None:
    """Raise BrokenLaw unless a condition holds, everywhere if it is one for each entry."""
    if not np.all(holds):
        raise BrokenLaw(array, law)


def require_mesh(arrays: Arrays, prefix: str, about: Mapping[str, Any]) -> Polyhedron:
    """The triangle mesh of arrays with a prefix: closed, connected, of the surface that the file names."""
    vertices, offsets, tail, twin, same = (
        arrays[f"{prefix}_{name}"] for name in ("vertices", "offsets", "tail", "twin", "same")
    )
    count, sides = len(vertices), len(tail)
    require(np.isfinite(vertices), f"{prefix}_vertices", "coordinates are finite")
    require(len(offsets) > 1 and sides == 3 * (len(offsets) - 1), f"{prefix}_offsets", "there is a triangle")
    require(offsets == 3 * np.arange(len(offsets)), f"{prefix}_offsets", "triangles have three corners")
    require((tail >= 0) & (tail < count), f"{prefix}_tail", f"vertices are 0 to {count - 1}")
    require(np.bincount(tail, minlength=count) > 0, f"{prefix}_tail", "every vertex lies in a triangle")
    require((twin >= 0) & (twin < sides), f"{prefix}_twin", f"halfedges are 0 to {sides - 1}")
    index = np.arange(sides)
    require((twin[twin] == index) & (twin != index), f"{prefix}_twin", "halfedges are glued in pairs")
    require(same[twin] == same, f"{prefix}_same", "two twins run alike, or both do not")
    mesh = Polyhedron(vertices, offsets, tail, twin, same)
    ends = tail == np.where(same, tail[twin], mesh.head[twin])
    require(ends, f"{prefix}_twin", "two twins have the same ends")
    found = surface_type(mesh)
    require(found.genus is not None, f"{prefix}_twin", "the triangles are one closed connected surface")
    alike = (found.euler_characteristic, found.orientable) == (about["euler_characteristic"], about["orientable"])
    named = f"Euler characteristic {about['euler_characteristic']} and orientable {about['orientable']}"
    require(alike, f"{prefix}_twin", f"the surface has {named}, as the file says; it is {found.name}")
    return mesh


def require_refinement(arrays: Arrays, coarse: Polyhedron, fine: Polyhedron) -> Bisection:
    """The forest of halved triangles, whose leaves are those of the fine mesh."""
    side, child = arrays["side"], arrays["child"]
    log = _log(arrays, coarse)
    roots, count = (coarse if log is None else log.after).face_count, len(side)
    require(count == 2 * fine.face_count - roots, "side", "every halved triangle has two halves")
    require((side >= -1) & (side <= 2), "side", "sides are 0, 1 and 2, or -1 at a leaf")
    node = np.flatnonzero(side >= 0)
    require(child[node] > node, "child", "halves come after the triangle")
    halves = np.concatenate([child[node], child[node] + 1])
    whole = len(halves) == count - roots and np.array_equal(np.sort(halves), np.arange(roots, count))
    require(whole, "child", "every triangle that is none of the coarse ones is half of one other")
    leaves = np.sort(child[side < 0])
    require(np.array_equal(leaves, np.arange(fine.face_count)), "child", "every fine triangle is one leaf")
    refinement = Bisection(coarse, fine, side, child, log)
    _require_halves(refinement)
    return refinement


def _require_halves(refinement: Bisection) -> None:
    """Two halves share the middle of a side and the opposite corner, and all of them make up the coarse triangles.

    By the numbers of vertices: where the vertices lie is free, as those of a smooth mesh are moved.
    """
    side, child, fine = refinement.side, refinement.child, refinement.polyhedron
    corners = np.empty((len(side), 3), dtype=np.intp)
    leaf = side < 0
    corners[leaf] = fine.triangles[child[leaf]]
    for node in reversed(_levels(side, child, refinement.facets.face_count)):
        first, second, start = corners[child[node]], corners[child[node] + 1], side[node]
        joined = (first[:, 2] == second[:, 2]) & (first[:, 1] == second[:, 0])
        require(joined, "child", "two halves have the middle of a side and the opposite corner in common")
        corners[node, start] = first[:, 0]
        corners[node, (start + 1) % 3] = second[:, 1]
        corners[node, (start + 2) % 3] = first[:, 2]
    whole = corners[: refinement.facets.face_count] == refinement.facets.triangles
    require(whole, "fine_tail", "fine triangles are halves of coarse ones")


def _log(arrays: Arrays, coarse: Polyhedron) -> EdgeLog | None:
    """The edges of the coarse mesh that are flipped or halved, if any: of two triangles that are neighbours by then."""
    if "flip_halfedge" not in arrays:
        return None
    halfedge, crossing = arrays["flip_halfedge"], arrays["flip_crossing"]
    halved = arrays.get("flip_halved", np.zeros(len(halfedge), dtype=np.bool_))
    sides = len(coarse.tail) + 6 * int(halved.sum())
    require((halfedge >= 0) & (halfedge < sides), "flip_halfedge", f"halfedges are 0 to {sides - 1}")
    require(halfedge[:, 0] // 3 != halfedge[:, 1] // 3, "flip_halfedge", "an edge of two triangles is flipped")
    shares = (crossing > 0) & (crossing < 1)
    require(shares[:, 0] & (crossing[:, 1] >= 0) & (crossing[:, 1] <= 1), "flip_crossing", "shares are 0 to 1")
    require(~halved | (crossing == [0.5, 0]).all(axis=1), "flip_crossing", "edges are halved in the middle")
    log = EdgeLog(coarse, halfedge, crossing, halved)
    require(log.is_sound, "flip_halfedge", "the two halfedges are twins at every step")
    return log


def _levels(side: Ints, child: Ints, roots: int) -> list[Ints]:
    """The triangles that are halved, those of each depth together, the coarse ones first."""
    levels: list[Ints] = []
    node = np.arange(roots)
    while len(node := node[side[node] >= 0]):
        require(len(levels) < _DEEPEST, "child", f"no triangle is halved more than {_DEEPEST} times")
        levels.append(node)
        node = np.concatenate([child[node], child[node] + 1])
    return levels


def require_atlas(arrays: Arrays, geometry: Any) -> Atlas:
    """Patches with transitions that are isometries, each with its inverse."""
    radius, tail, head, inverse, isometry = (
        arrays[f"atlas_{name}"] for name in ("radius", "tail", "head", "inverse", "isometry")
    )
    patches, count = len(radius), len(tail)
    require(patches > 0 and np.isfinite(radius).all() and (radius > 0).all(), "atlas_radius", "radii are positive")
    for name, ends in (("atlas_tail", tail), ("atlas_head", head)):
        require(count > 0 and ends[0] == -1, name, "transition 0 is the identity, of no patch")
        require((ends[1:] >= 0) & (ends[1:] < patches), name, f"patches are 0 to {patches - 1}")
    require((inverse >= 0) & (inverse < count), "atlas_inverse", f"transitions are 0 to {count - 1}")
    paired = (inverse[inverse] == np.arange(count)) & (tail[inverse] == head)
    require(paired & (inverse[0] == 0), "atlas_inverse", "the inverse leads back")
    require(np.isfinite(isometry), "atlas_isometry", "entries are finite")
    require(isometry[0] == np.eye(3), "atlas_isometry", "transition 0 is the identity")
    with np.errstate(all="ignore"):
        scale = np.maximum(1.0, np.abs(isometry).max(axis=(1, 2))) ** 2
        require(geometry.isometry_defect(isometry) <= _NEAR * scale, "atlas_isometry", _isometries(geometry))
        back = np.abs(geometry.inverse(isometry) - isometry[inverse]).max(axis=(1, 2))
        require(back <= _NEAR * scale, "atlas_isometry", "the inverse of a transition is its inverse isometry")
    return Atlas(geometry, radius, tail, head, inverse, isometry)


def _isometries(geometry: Any) -> str:
    return f"transitions are isometries of {geometry.name}"


def require_map(triangulation: Triangulation) -> None:
    """Points of X in their patches, transitions that lead from patch to patch, and no triangle folded over."""
    atlas, mesh = triangulation.orbifold.atlas, triangulation.polyhedron
    patch, points, step = triangulation.patch, triangulation.points, triangulation.transition
    geometry = atlas.geometry
    require((patch >= 0) & (patch < atlas.patch_count), "patch", f"patches are 0 to {atlas.patch_count - 1}")
    require(np.bincount(patch, minlength=atlas.patch_count) > 0, "atlas_radius", "every patch holds a vertex")
    require(np.isfinite(points), "points", "coordinates are finite")
    with np.errstate(all="ignore"):
        require(geometry.point_defect(points) <= _NEAR * _squares(points), "points", f"they lie in {geometry.name}")
    require((step >= 0) & (step < len(atlas.tail)), "transition", f"transitions are 0 to {len(atlas.tail) - 1}")
    ends = patch[mesh.tail], patch[mesh.head]
    leads = np.where(step > 0, (atlas.tail[step] == ends[0]) & (atlas.head[step] == ends[1]), ends[0] == ends[1])
    require(leads, "transition", "each leads from the patch of the end of a halfedge to that of its start")
    again = np.where(mesh.same, step, atlas.inverse[step])
    require(step[mesh.twin] == again, "transition", "twins have inverse transitions, or the same if they run alike")
    with np.errstate(all="ignore"):
        _require_reach(triangulation)
        require(triangulation.relation_defect <= _ROUGHLY, "transition", "those round a triangle are the identity")
        try:
            folded = triangulation.not_positive
        except OrbiframeError as error:
            raise BrokenLaw("transition", str(error)) from error
        require(folded == 0, "points", f"no triangle is folded over; {folded} are")
        require(triangulation.area_defect <= _ROUGHLY, "area", "it is the sum of the areas of the triangles")
    _require_area(triangulation)


def require_creases(triangulation: Triangulation) -> None:
    """Creases that are whole edges, and run along geodesics from site to site of the domain of the functions."""
    crease, sites, mesh = triangulation.crease, triangulation.sites, triangulation.polyhedron
    _require_seams(triangulation)
    require((crease is None) == (sites is None), "sites", "there are sites if there are creases, and only then")
    if crease is None or sites is None:
        return
    count = len(mesh.vertices)
    require(crease[mesh.twin] == crease, "crease", "both halfedges of an edge are on a crease, or none is")
    require(crease.any(), "crease", "there is a crease")
    require((sites >= 0) & (sites < count), "sites", f"vertices are 0 to {count - 1}")
    require(np.diff(np.sort(sites)) > 0, "sites", "they are different")
    ends = np.concatenate([mesh.tail, mesh.head])[np.tile(crease & mesh.representative, 2)]
    degree = np.bincount(ends, minlength=count)
    require(
        np.isin(np.flatnonzero((degree > 0) & (degree != 2)), sites), "sites", "ends and corners of creases are sites"
    )
    require(off_geodesics(triangulation) <= _NEAR, "points", "creases run along geodesics from site to site")
    try:
        crease_triangulation(triangulation)
    except OrbiframeError as error:
        raise BrokenLaw("sites", f"their Delaunay triangulation has the creases as edges; {error}") from error


def _require_seams(triangulation: Triangulation) -> None:
    seam, crease, twin = triangulation.seam, triangulation.crease, triangulation.polyhedron.twin
    if seam is not None:
        require(seam[twin] == seam, "seam", "both halfedges of an edge are on a seam, or none is")
        require(~seam if crease is None else crease | ~seam, "seam", "seams are among the creases")


def require_inside(triangulation: Triangulation, refinement: Bisection) -> None:
    """Triangles that belong to a mesh with a boundary: some, not all, and all or none of a triangle of the input."""
    inside = triangulation.inside
    if inside is None:
        return
    count = triangulation.polyhedron.face_count
    require(len(inside) == count, "inside", f"it has an entry for each of {count} triangles")
    require(inside.any() and not inside.all(), "inside", "some triangles belong to the mesh and some do not")
    marks = np.repeat(inside[refinement.in_facets()].astype(float), 3).reshape(-1, 3, 1)
    require((refinement.spread(marks)[:, 0, 0] > 0.5) == inside, "inside", "triangles of the input are not divided")


def _squares(points: Floats) -> Floats:
    return np.asarray(np.maximum(1.0, np.abs(points).max(axis=1)) ** 2)


def _require_reach(triangulation: Triangulation) -> None:
    """The radius of a patch is the distance of the farthest corner of a triangle that has a corner in the patch."""
    atlas, mesh = triangulation.orbifold.atlas, triangulation.polyhedron
    geometry, step = atlas.geometry, triangulation.transition
    reach = np.zeros(atlas.patch_count)
    own = triangulation.patch, triangulation.points
    ahead = triangulation.patch[mesh.tail], geometry.act(atlas.isometry[step], triangulation.points[mesh.head])
    inverse = atlas.isometry[atlas.inverse[step]]
    behind = triangulation.patch[mesh.head], geometry.act(inverse, triangulation.points[mesh.tail])
    for patch, x in (own, ahead, behind):
        np.maximum.at(reach, patch, geometry.distance(geometry.origin, x))
    require(np.isfinite(reach), "points", "they lie at finite distances")
    require(atlas.radius >= reach * (1 - _NEAR) - _NEAR, "atlas_radius", "patches hold their triangles")
    most = np.maximum(2 * reach, np.pi if geometry.curvature > 0 else 0.0)
    require(atlas.radius <= most * (1 + _NEAR), "atlas_radius", "patches reach as far as their triangles")


def _require_area(triangulation: Triangulation) -> None:
    orbifold = triangulation.orbifold
    curvature, chi = orbifold.geometry.curvature, orbifold.euler_characteristic
    require(np.isfinite(orbifold.area) and orbifold.area > 0, "area", "it is positive")
    if curvature:
        near = abs(orbifold.area * curvature - 2 * np.pi * chi) <= _NEAR * orbifold.area
        require(near, "area", "it is 2 pi |chi| (Gauss-Bonnet)")
