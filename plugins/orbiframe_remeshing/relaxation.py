"""Relaxation: vertices move over the surface to the middle of their triangles in space, and edges flip."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions import around, foot_step, moved
from orbiframe_remeshing.flips import flipped_for_angles, flipped_for_valences
from orbiframe_remeshing.surface_mesh import SurfaceMesh, cross, jets_at, least_angles, shortest_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Steps with flips for the valences, then steps without.
_STEPS = (10, 5)
# How far a vertex goes in one step, of its shortest edge.
_FAR = 0.35
# Triangles with a least angle below this are looked at one by one; where a vertex is tried, of its shortest edge.
_POOR, _TRIALS, _ROUNDS = 30.0, (0.3, 0.1, 0.03), 20
_GAIN = 1e-3


def relaxed(mesh: SurfaceMesh) -> SurfaceMesh:
    """The mesh with even triangles: every vertex steps towards the centroid of its triangles, weighted by area.

    The step is that of Gauss and Newton to the foot of the centroid, along a geodesic of X: all vertices stay on the
    surface. Last come the poor triangles, whose vertices try places about them for a larger least angle.
    """
    with_valences, without = _STEPS
    for number in range(with_valences + without):
        triangles = flipped_for_angles(mesh.places, mesh.triangles, mesh.creases)
        if number < with_valences:
            triangles = flipped_for_valences(mesh.places, triangles, mesh.creases, mesh.regular)
        mesh = stepped(mesh.joined_by(triangles))
    mesh = mended(mesh.joined_by(flipped_for_angles(mesh.places, mesh.triangles, mesh.creases)), _POOR)
    return mesh.joined_by(flipped_for_angles(mesh.places, mesh.triangles, mesh.creases))


def stepped(mesh: SurfaceMesh) -> SurfaceMesh:
    """Every vertex off creases and boundary a step nearer to the centroid of its triangles.

    At most 0.35 of its shortest edge.
    """
    flat = np.concatenate([mesh.jets, np.zeros_like(mesh.jets)])
    longest = _FAR * shortest_edges(mesh.places, mesh.triangles)
    step = foot_step(flat, centroids(mesh.places, mesh.triangles), longest, bent=False)
    step[mesh.fixed] = 0.0
    points = moved(mesh.surface.orbifold, mesh.points, step)
    return replace(SurfaceMesh.at(mesh.surface, points, mesh.triangles), creases=mesh.creases, rim=mesh.rim)


def centroids(places: Floats, triangles: Ints) -> Floats:
    """The centroid of the triangles round every vertex, (V, 3)."""
    area = np.linalg.norm(cross(places, triangles), axis=1)
    weighted = np.column_stack([area[:, None] * places[triangles].mean(axis=1), area])
    vertex, rows = triangles.ravel(), np.repeat(weighted, 3, axis=0)
    total = np.stack([np.bincount(vertex, weights=row, minlength=len(places)) for row in rows.T], axis=1)
    return np.asarray(total[:, :3] / np.maximum(total[:, 3:], np.finfo(float).tiny))


def mended(mesh: SurfaceMesh, poor: float) -> SurfaceMesh:
    """The mesh with vertices of poor triangles moved, as long as that makes least angles larger, 20 times at most.

    poor: triangles with a least angle below that, in degrees. No two vertices of one triangle move at once, and no
    triangle turns over.
    """
    for _ in range(_ROUNDS):
        better = _mended_once(mesh, poor)
        if better is mesh:
            break
        mesh = better
    return mesh


def _mended_once(mesh: SurfaceMesh, poor: float) -> SurfaceMesh:
    """Some vertices at better places; the same mesh if there are none."""
    least = least_angles(mesh.places, mesh.triangles)
    chosen = np.unique(mesh.triangles[least < poor])
    chosen = chosen[~mesh.fixed[chosen]]
    if not len(chosen):
        return mesh
    slot, star = _stars(mesh.triangles, chosen)
    radius = shortest_edges(mesh.places, mesh.triangles)[chosen]
    steps = np.concatenate([around(mesh.jets[:, chosen], share * radius) for share in _TRIALS])
    here = type(mesh.points)(mesh.points.patch[chosen], mesh.points.x[chosen])
    trials = [moved(mesh.surface.orbifold, here, step) for step in steps]
    jets = np.stack([jets_at(mesh.surface, trial) for trial in trials])
    quality = np.stack([_star_quality(mesh, chosen, slot, star, jet[0]) for jet in jets])
    best = quality.argmax(axis=0)
    before = np.full(len(chosen), np.inf)
    np.minimum.at(before, slot, least[star])
    gain = quality[best, np.arange(len(chosen))] - before
    taken = _first_claims(gain, slot, star, len(least))
    if not len(taken):
        return mesh
    x = np.stack([trial.x for trial in trials])[best[taken], taken]
    patch = np.stack([trial.patch for trial in trials])[best[taken], taken]
    return mesh.with_points(chosen[taken], type(mesh.points)(patch, x), jets[best[taken], :, taken].swapaxes(0, 1))


def _stars(triangles: Ints, chosen: Ints) -> tuple[Ints, Ints]:
    """All pairs of a place in `chosen` and a triangle round that vertex."""
    place = np.full(triangles.max() + 1, -1)
    place[chosen] = np.arange(len(chosen))
    face, corner = np.nonzero(place[triangles] >= 0)
    return np.asarray(place[triangles[face, corner]]), np.asarray(face)


def _star_quality(mesh: SurfaceMesh, chosen: Ints, slot: Ints, star: Ints, places: Floats) -> Floats:
    """The least angle round each chosen vertex, (n,), if it alone moved to its place; -1 if a triangle turned over."""
    corners = mesh.places[mesh.triangles[star]]
    was = mesh.triangles[star] == chosen[slot][:, None]
    own = np.where(was[..., None], places[slot][:, None], corners).reshape(-1, 3)
    faces = np.arange(len(own)).reshape(-1, 3)
    upright = np.einsum("fi,fi->f", cross(own, faces), cross(corners.reshape(-1, 3), faces)) > 0
    quality = np.full(len(chosen), np.inf)
    np.minimum.at(quality, slot, np.where(upright, least_angles(own, faces), -1.0))
    return quality


def _first_claims(gain: Floats, slot: Ints, star: Ints, count: int) -> Ints:
    """Vertices that gain, of which no two have a triangle in common; those that gain most come first."""
    rank = np.empty(len(gain), dtype=np.intp)
    rank[np.argsort(-gain, kind="stable")] = np.arange(len(gain))
    rank[gain <= _GAIN] = len(gain)
    first = np.full(count, len(gain))
    np.minimum.at(first, star, rank[slot])
    beaten = np.zeros(len(gain), dtype=np.bool_)
    beaten[slot[first[star] != rank[slot]]] = True
    return np.flatnonzero(~beaten & (rank < len(gain)))
