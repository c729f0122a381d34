"""Developing: from edge lengths of a metric of constant curvature to an atlas and a triangulation of X/H."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import Atlas, Geometry, MapError, Orbifold, Polyhedron, SurfaceType, Triangulation
from orbiframe.compiled import compiled, copy, multiply
from orbiframe.meshes import covering_points, dijkstra_forest, edge_graph
from orbiframe_parametrizers.relations import with_relations

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

_SAME = 1e-4
_SPANNED, _FACTOR = np.log(1e5), np.log(400)


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
    edges = np.flatnonzero(mesh.representative)
    ends = mesh.tail[edges], mesh.head[edges]
    labels = _labels(frames, geometry.inverse(frames), steps[edges], *ends)
    along, tail, head, isometry = _classes(geometry, patch[ends[0]], patch[ends[1]], labels)
    transition = _on_halfedges(mesh, edges, along)
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
    before = np.empty(len(mesh.tail), dtype=np.intp)
    before[mesh.next] = np.arange(len(mesh.tail))
    first, last, sense = _walked(mesh.tail, mesh.next, before, mesh.twin, mesh.same, angles, len(mesh.vertices))
    return first, last[mesh.next], sense


@compiled
def _walked(tail, following, before, twin, same, angles, count):  # type: ignore[no-untyped-def]
    """Angles at which the two edges of every corner leave its vertex, and the sense of the corner."""
    first, last = np.empty(len(tail)), np.empty(len(tail))
    sense, begun = np.ones(len(tail), dtype=np.bool_), np.zeros(count, dtype=np.bool_)
    for start in range(len(tail)):
        if begun[tail[start]]:
            continue
        begun[tail[start]] = True
        corner, forward, angle = start, True, 0.0
        while True:
            after = angle + angles[corner]
            first[corner], last[corner] = (angle, after) if forward else (after, angle)
            sense[corner] = forward
            crossed = before[corner] if forward else corner
            # The twin leaves this vertex, so that its corner is here, exactly if the direction flag says so.
            forward = forward != same[crossed]
            corner = twin[crossed] if forward else following[twin[crossed]]
            angle = after
            if corner == start:
                break
    return first, last, sense


def edge_isometries(mesh: Polyhedron, geometry: Geometry, lengths: Floats, angles: Floats) -> Floats:
    """For every halfedge from i to j the isometry from the frame at j to the frame at i, (H, 3, 3).

    lengths: (H,), of the edges; angles: (H,), of the corners, 2 pi in all round every vertex.

    Turn the direction of the edge at j to the x1-axis, reflect in that axis if the two frames have opposite senses,
    turn by pi, move by the length, turn the axis into the direction of the edge at i.
    """
    outgoing, incoming, sense = _edge_directions(mesh, angles)
    edges = np.flatnonzero(mesh.representative)
    mirror = np.where(sense[edges] != sense[mesh.next[edges]], -1.0, 1.0)
    along = _edge_products(geometry, outgoing[edges], lengths[edges], mirror, incoming[edges])
    return on_both_halfedges(mesh, geometry, edges, along)


def on_both_halfedges(mesh: Polyhedron, geometry: Geometry, edges: Ints, along: Floats) -> Floats:
    """Isometries (H, 3, 3) from those along one halfedge of every edge; a twin the other way has the inverse."""
    steps = np.empty((len(mesh.tail), 3, 3))
    steps[mesh.twin[edges]] = np.where(mesh.same[edges, None, None], along, geometry.inverse(along))
    steps[edges] = along
    return steps


def _edge_products(geometry: Geometry, outgoing: Floats, lengths: Floats, mirror: Floats, incoming: Floats) -> Floats:
    """rotation(outgoing) translation(length) rotation(pi) diag(1, 1, mirror) rotation(-incoming), multiplied out."""
    cosine, sine, _ = np.moveaxis(geometry.from_polar(lengths, 0.0), -1, 0)
    ahead = np.stack([np.cos(outgoing), np.sin(outgoing)], axis=-1)
    aside = np.stack([-ahead[:, 1], ahead[:, 0]], axis=-1)
    back = -np.stack([np.cos(incoming), np.sin(incoming)], axis=-1)
    across = mirror[:, None] * np.stack([-back[:, 1], back[:, 0]], axis=-1)
    product = np.empty((len(lengths), 3, 3))
    product[:, 0, 0] = cosine
    product[:, 1:, 0] = sine[:, None] * ahead
    product[:, 0, 1:] = -geometry.curvature * sine[:, None] * back
    product[:, 1:, 1:] = (cosine[:, None] * ahead)[:, :, None] * back[:, None, :] + aside[:, :, None] * across[
        :, None, :
    ]
    return product


@compiled
def _labels(frames, inverses, steps, tail, head):  # type: ignore[no-untyped-def]
    """frames[tail] steps inverses[head], (E, 3, 3)."""
    labels = np.empty_like(steps)
    half = np.empty((3, 3))
    for edge in range(len(steps)):
        multiply(frames[tail[edge]], steps[edge], half)
        multiply(half, inverses[head[edge]], labels[edge])
    return labels


def _patch_frames(
    mesh: Polyhedron, geometry: Geometry, lengths: Floats, steps: Floats, patch_radius: float
) -> tuple[Ints, Floats]:
    """The patch of every vertex, (V,), and the isometry from its own frame to that of its patch, (V, 3, 3).

    Distance is the length in X plus 1.5 times the length in space over the size of the mesh: where the map crowds
    much of the surface into little of X/H, patches shrink with the scale and coordinates keep their digits. Where the
    scale changes by many digits along a thin limb, so much of it as changes it by a factor of 400 is a distance of 1.
    """
    scale = 1.5 / max(mesh.diagonal, np.finfo(float).tiny)
    graph = edge_graph(mesh, lengths + scale * mesh.edge_lengths + _scale_steps(mesh, lengths))
    forest = dijkstra_forest(graph, covering_points(graph, patch_radius))
    last = np.flatnonzero(forest.link >= 0)
    halfedge, backward = graph.halfedge[forest.link[last]], graph.backward[forest.link[last]]
    onward = np.broadcast_to(np.eye(3), (len(mesh.vertices), 3, 3)).copy()
    onward[last] = np.where(backward[:, None, None], geometry.inverse(steps[halfedge]), steps[halfedge])
    _carry(forest.order, forest.parent, onward)
    return forest.owner, onward


def _scale_steps(mesh: Polyhedron, lengths: Floats) -> Floats:
    """How much the scale of a map changes along each edge, (H,): a sixth of the change of its logarithm.

    0 where the scale spans less than five digits: coordinates have enough of them.
    """
    count = len(mesh.vertices)
    in_x, in_space = (np.bincount(mesh.tail, weights=part, minlength=count) for part in (lengths, mesh.edge_lengths))
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = np.log(in_x / in_space)
    if not np.isfinite(scale).all() or np.ptp(scale) < _SPANNED:
        return np.zeros(len(lengths))
    return np.asarray(np.abs(scale[mesh.head] - scale[mesh.tail]) / _FACTOR)


@compiled
def _carry(order, parent, frames):  # type: ignore[no-untyped-def]
    """Frames seen from those of their parents become frames seen from their roots."""
    own = np.empty((3, 3))
    for vertex in order:
        if parent[vertex] < 0:
            continue
        copy(frames[vertex], own)
        multiply(frames[parent[vertex]], own, frames[vertex])


def _classes(geometry: Geometry, tail: Ints, head: Ints, labels: Floats) -> tuple[Ints, Ints, Ints, Floats]:
    """The transition of every edge (E,), and the tails, heads and isometries of the transitions.

    tail, head: (E,), patches at the two ends. Labels of one homotopy class between two patches agree up to rounding;
    the first edge in each round speaks for its class. Transitions come in pairs, each followed by its inverse, after
    the identity.
    """
    transition = np.zeros(len(tail), dtype=np.intp)
    tails, heads, isometries = [np.array([-1])], [np.array([-1])], [np.eye(3)[None]]
    backward = tail > head
    upward = labels
    upward[backward] = geometry.inverse(labels[backward])
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    within = np.flatnonzero(low == high)
    trivial = np.zeros(len(tail), dtype=np.bool_)
    trivial[within] = np.abs(upward[within] - np.eye(3)).max(axis=(1, 2)) < _SAME
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


def _on_halfedges(mesh: Polyhedron, edges: Ints, transition: Ints) -> Ints:
    """The transitions (H,) of both halfedges of every edge: the inverse on a twin that runs the other way."""
    inverse = np.where(transition > 0, 1 + ((transition - 1) ^ 1), 0)
    everywhere = np.empty(len(mesh.tail), dtype=np.intp)
    everywhere[edges] = transition
    everywhere[mesh.twin[edges]] = np.where(mesh.same[edges], transition, inverse)
    return everywhere


def _close(a: Floats, b: Floats) -> Bools:
    return np.asarray(np.abs(a - b).max(axis=(1, 2)) < _SAME * np.maximum(1.0, np.abs(b).max(axis=(1, 2))))


def with_patch_radii(triangulation: Triangulation) -> Triangulation:
    """The same map with the radius of every patch set to the farthest corner of a triangle that has a corner in it."""
    mesh, atlas = triangulation.polyhedron, triangulation.orbifold.atlas
    transition = triangulation.transition
    radius = np.zeros(atlas.patch_count)
    crossing = np.flatnonzero(transition)
    parallel = crossing[mesh.same[crossing]]
    tail, head = mesh.tail[crossing], mesh.head[crossing]
    # Seen from the patch of its head a halfedge is its twin, or, where both run the same way, it is looked at itself.
    there = atlas.isometry[transition[crossing]]
    back = atlas.isometry[atlas.inverse[transition[parallel]]]
    for patch, x in (
        (triangulation.patch, triangulation.points),
        (triangulation.patch[tail], atlas.geometry.act(there, triangulation.points[head])),
        (triangulation.patch[mesh.head[parallel]], atlas.geometry.act(back, triangulation.points[mesh.tail[parallel]])),
    ):
        np.maximum.at(radius, patch, atlas.geometry.distance(atlas.geometry.origin, x))
    if not np.isfinite(radius).all():
        raise MapError("the patches of X/H could not be laid out: an edge is too long; refine the mesh")
    orbifold = replace(triangulation.orbifold, atlas=replace(atlas, radius=radius))
    return replace(triangulation, orbifold=orbifold)
