"""Developing: from edge lengths of a metric of constant curvature to an atlas and a triangulation of X/H."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import (
    Atlas,
    Geometry,
    MapError,
    Orbifold,
    Polyhedron,
    SurfaceType,
    Triangulation,
    dijkstra_forest,
    edge_graph,
    farthest_points,
)
from orbiframe_parametrizers.relations import with_relations

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

_SAME = 1e-4


def developed(
    mesh: Polyhedron, geometry: Geometry, lengths: Floats, angles: Floats, *, surface: SurfaceType, patch_radius: float
) -> Triangulation:
    """The triangulation of X/H whose edges have the given lengths (H,) and whose corners have the given angles (H,).

    The angle sums must be 2 pi. X/H is split into patches of about `patch_radius`, grown by shortest paths from
    vertices spread evenly; each has a frame at its centre, and the frames of its vertices follow by short products of
    edge isometries. The label of an edge is the isometry between the frames of two patches: all edges between two
    patches in the same homotopy class share one, which is then projected onto the relations round the triangles. So
    no number ever leaves the neighbourhood of the origin, at any genus.
    """
    steps = edge_isometries(mesh, geometry, lengths, angles)
    return in_patches(mesh, geometry, lengths, steps, surface=surface, patch_radius=patch_radius)


def in_patches(
    mesh: Polyhedron, geometry: Geometry, lengths: Floats, steps: Floats, *, surface: SurfaceType, patch_radius: float
) -> Triangulation:
    """The triangulation of X/H from frames at the vertices, of which only the steps between neighbours are known.

    lengths: (H,) in X; steps: (H, 3, 3), for a halfedge from i to j the isometry from the frame at j to the frame at i,
    exactly the inverse of that of its twin (the same, if the twin runs the same way). Each vertex is the origin of its
    frame. See `developed` for the rest.
    """
    patch, frames = _patch_frames(mesh, geometry, lengths, steps, patch_radius)
    labels = frames[mesh.tail] @ steps @ geometry.inverse(frames[mesh.head])
    transition, tail, head, isometry = _classes(mesh, geometry, patch, labels)
    isometry = with_relations(geometry, transition, isometry)
    inverse = np.concatenate([[0], 1 + (np.arange(len(tail) - 1) ^ 1)])
    points = geometry.settle(frames[..., 0])
    atlas = Atlas(geometry, np.full(int(patch.max()) + 1, np.inf), tail, head, inverse, isometry)
    area = 2 * np.pi * abs(surface.euler_characteristic)
    orbifold = Orbifold(atlas, surface.euler_characteristic, surface.orientable, area)
    draft = Triangulation(orbifold, mesh, patch, points, transition)
    if geometry.curvature == 0:
        draft = replace(draft, orbifold=replace(orbifold, area=float(draft.areas.sum())))
    return with_patch_radii(draft)


def _edge_directions(mesh: Polyhedron, angles: Floats) -> tuple[Floats, Floats, Bools]:
    """Polar angles round the vertices: of every halfedge at its tail, at its head, and the sense of each corner.

    A walk round each vertex sums the corner angles. Crossing an edge whose twin runs the same way flips the sense in
    which the next face is passed: the sense (H,) is True where the walk passes the face's corner counterclockwise.
    """
    size = len(mesh.tail)
    before = np.empty(size, dtype=np.intp)
    before[mesh.next] = np.arange(size)
    first = np.full(size, np.nan)
    last = np.full(size, np.nan)
    sense = np.ones(size, dtype=np.bool_)
    _, corner = np.unique(mesh.tail, return_index=True)
    angle = np.zeros(len(corner))
    forward = np.ones(len(corner), dtype=np.bool_)
    while len(corner):
        after = angle + angles[corner]
        first[corner] = np.where(forward, angle, after)
        last[corner] = np.where(forward, after, angle)
        sense[corner] = forward
        crossed = np.where(forward, before[corner], corner)
        twin = mesh.twin[crossed]
        # The twin leaves this vertex, so that its corner is here, exactly if the direction flag says so.
        leaves = forward ^ mesh.same[crossed]
        corner = np.where(leaves, twin, mesh.next[twin])
        angle, forward = after, leaves
        fresh = np.isnan(first[corner])
        corner, angle, forward = corner[fresh], angle[fresh], forward[fresh]
    return first, last[mesh.next], sense


def edge_isometries(mesh: Polyhedron, geometry: Geometry, lengths: Floats, angles: Floats) -> Floats:
    """For every halfedge from i to j the isometry from the frame at j to the frame at i, (H, 3, 3).

    lengths: (H,), of the edges; angles: (H,), of the corners, 2 pi in all round every vertex.

    Turn the direction of the edge at j to the x1-axis, reflect in that axis if the two frames have opposite senses,
    turn by pi, move by the length, turn the axis into the direction of the edge at i.
    """
    outgoing, incoming, sense = _edge_directions(mesh, angles)
    flipped = sense != sense[mesh.next]
    mirror = np.where(flipped[:, None, None], np.diag([1.0, 1.0, -1.0]), np.eye(3))
    there = geometry.rotation(np.pi) @ mirror @ geometry.rotation(-incoming)
    steps = geometry.rotation(outgoing) @ geometry.translation(lengths) @ there
    other = np.flatnonzero(~mesh.representative)
    twin = mesh.twin[other]
    same = mesh.same[other, None, None]
    steps[other] = np.where(same, steps[twin], geometry.inverse(steps[twin]))
    return steps


def _patch_frames(
    mesh: Polyhedron, geometry: Geometry, lengths: Floats, steps: Floats, patch_radius: float
) -> tuple[Ints, Floats]:
    """The patch of every vertex, (V,), and the isometry from its own frame to that of its patch, (V, 3, 3).

    Distance is the length in X plus 1.5 times the length in space over the size of the mesh: where the map crowds
    much of the surface into little of X/H, patches shrink with the scale and coordinates keep their digits.
    """
    scale = 1.5 / max(mesh.diagonal, np.finfo(float).tiny)
    graph = edge_graph(mesh, lengths + scale * mesh.edge_lengths)
    centres = farthest_points(graph, len(mesh.vertices), radius=patch_radius).chosen
    forest = dijkstra_forest(graph, centres)
    frames = np.broadcast_to(np.eye(3), (len(mesh.vertices), 3, 3)).copy()
    for generation in _generations(forest.parent):
        link = forest.link[generation]
        halfedge = graph.halfedge[link]
        step = steps[halfedge]
        step = np.where(graph.backward[link][:, None, None], geometry.inverse(step), step)
        frames[generation] = frames[forest.parent[generation]] @ step
    return forest.owner, frames


def _generations(parent: Ints) -> list[Ints]:
    """The vertices of a forest without its roots, by their number of steps from a root."""
    depth = np.zeros(len(parent), dtype=np.intp)
    active = np.flatnonzero(parent >= 0)
    ancestor = parent.copy()
    while len(active):
        depth[active] += 1
        ancestor[active] = parent[ancestor[active]]
        active = active[ancestor[active] >= 0]
    by_depth = np.argsort(depth, kind="stable")
    bounds = np.searchsorted(depth[by_depth], np.arange(depth.max() + 2))
    return [by_depth[bounds[d] : bounds[d + 1]] for d in range(1, int(depth.max()) + 1)]


def _classes(mesh: Polyhedron, geometry: Geometry, patch: Ints, labels: Floats) -> tuple[Ints, Ints, Ints, Floats]:
    """The transition of every halfedge (H,), and the tails, heads and isometries of the transitions.

    Labels of one homotopy class between two patches agree up to rounding; the first halfedge in each round speaks for
    its class. Transitions come in pairs, each followed by its inverse, after the identity.
    """
    transition = np.zeros(len(mesh.tail), dtype=np.intp)
    tails, heads, isometries = [np.array([-1])], [np.array([-1])], [np.eye(3)[None]]
    from_patch, to_patch = patch[mesh.tail], patch[mesh.head]
    backward = from_patch > to_patch
    upward = np.where(backward[:, None, None], geometry.inverse(labels), labels)
    low, high = np.minimum(from_patch, to_patch), np.maximum(from_patch, to_patch)
    trivial = (low == high) & (np.abs(upward - np.eye(3)).max(axis=(1, 2)) < _SAME)
    todo = np.flatnonzero(~trivial)
    todo = todo[np.lexsort((todo, high[todo], low[todo]))]
    count = 1
    while len(todo):
        new_pair = np.append(True, (np.diff(low[todo]) != 0) | (np.diff(high[todo]) != 0))
        group = np.cumsum(new_pair) - 1
        speaker = todo[new_pair]
        model = upward[speaker]
        plain = _close(upward[todo], model[group])
        turned = (low[todo] == high[todo]) & ~plain & _close(geometry.inverse(upward[todo]), model[group])
        number = count + 2 * group
        reverse = backward[todo] ^ turned
        member = plain | turned
        transition[todo[member]] = (number + reverse)[member]
        both = np.stack([model, geometry.inverse(model)], axis=1).reshape(-1, 3, 3)
        tails.append(np.stack([low[speaker], high[speaker]], axis=1).ravel())
        heads.append(np.stack([high[speaker], low[speaker]], axis=1).ravel())
        isometries.append(both)
        count += 2 * len(speaker)
        todo = todo[~member]
    return transition, np.concatenate(tails), np.concatenate(heads), np.concatenate(isometries)


def _close(a: Floats, b: Floats) -> Bools:
    return np.asarray(np.abs(a - b).max(axis=(1, 2)) < _SAME * np.maximum(1.0, np.abs(b).max(axis=(1, 2))))


def with_patch_radii(triangulation: Triangulation) -> Triangulation:
    """The same map with the radius of every patch set to the farthest corner of a triangle that has a corner in it."""
    mesh, atlas = triangulation.polyhedron, triangulation.orbifold.atlas
    transition = triangulation.transition
    radius = np.zeros(atlas.patch_count)
    own, far = triangulation.points[mesh.tail], triangulation.points[mesh.head]
    back = atlas.isometry[atlas.inverse[transition]]
    for vertex, x in (
        (mesh.tail, own),
        (mesh.tail, atlas.geometry.act(atlas.isometry[transition], far)),
        (mesh.head, atlas.geometry.act(back, own)),
    ):
        np.maximum.at(radius, triangulation.patch[vertex], atlas.geometry.distance(atlas.geometry.origin, x))
    if not np.isfinite(radius).all():
        raise MapError("the patches of X/H could not be laid out: an edge is too long; refine the mesh")
    orbifold = replace(triangulation.orbifold, atlas=replace(atlas, radius=radius))
    return replace(triangulation, orbifold=orbifold)
