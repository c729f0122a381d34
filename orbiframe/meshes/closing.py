"""Closing: an open mesh made closed by faces of no meaning, so that it has a map to X/H.

Only the lengths of the added edges count: they decide how the map goes on beyond the boundary. A cap joins each loop to
a point in its middle by rings of fewer and fewer vertices. A collar first goes on outward, in the planes of the faces
at the boundary, so that the surface may end there as if it did not end. The double is the mesh with its collar, and
once more a copy of both, reversed, glued along the outer edge: long tubes stay of one width there, where caps would
make a sphere with two long limbs of them.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import TopologyError
from orbiframe.meshes.loops import Loop, boundary_loops
from orbiframe.meshes.orientation import reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Closing = Literal["cap", "collar", "double"]

_RINGS = 2
# Rounds in which the directions of a collar are averaged along its loop, and at most its rings: teeth of the boundary
# must not cross in it.
_ROUNDS, _MOST_ROUNDS = 2, 200
# A collar in a hole ends at this share of its radius; a step of so much of the radius tells what lies in a hole.
_OF_HOLE, _TRIED = 0.35, 0.1
# A ring of no more vertices is joined to the middle; a larger one to a ring of half as many.
_FEW = 8


def closed_by(mesh: Polyhedron, how: Closing, width: float) -> Polyhedron:
    """The mesh with its boundary loops closed; its own faces, edges and vertices come first and keep their numbers.

    width: that of a collar, in space. Raises TopologyError for loops that touch, or that have fewer than three edges.
    """
    loops = boundary_loops(mesh)
    small = [loop for loop in loops if len(loop.vertices) < 3]
    if small:
        raise TopologyError(
            f"a boundary loop at vertex {small[0].vertices[0]} has {len(small[0].vertices)} edges; a hole has three at "
            "least: put a vertex on one of them"
        )
    strips = _RINGS if how != "cap" else 0
    patches = [_patch(mesh, loop, strips, width, open_=how == "double") for loop in loops]
    found = _glued(mesh, loops, patches)
    return _doubled(found) if how == "double" else found


def _patch(mesh: Polyhedron, loop: Loop, strips: int, width: float, *, open_: bool) -> tuple[Floats, Ints]:
    """The vertices beyond a loop, (m, 3), and triangles (t, 3), whose corners count the loop first.

    The first triangles lie at the edges of the loop in order, and their first sides run against it.
    """
    points, count = loop.points(mesh), len(loop.vertices)
    rings = [points, *_collar(mesh, loop, strips, width)]
    number = [count * k + np.arange(count) for k in range(len(rings))]
    triangles = [_strip(inner, outer) for inner, outer in pairwise(number)]
    if not open_:
        more, last = _cap(rings[-1], number[-1])
        rings, triangles = [*rings, more], [*triangles, last]
    return np.concatenate(rings[1:]), np.concatenate(triangles)


def _collar(mesh: Polyhedron, loop: Loop, strips: int, width: float) -> list[Floats]:
    """Rings beside a loop, outward in the planes of its faces."""
    if not strips:
        return []
    points = loop.points(mesh)
    # On a loop of few long edges nothing is averaged: its corners are no teeth.
    edges = width / max(loop.length(mesh) / len(points), np.finfo(float).tiny)
    way = _outward(mesh, loop, min(int(edges**2), _ROUNDS))
    length = _around(points)
    # The radius of a circle, and of teeth about one.
    hole = 2 * _area(points) / max(length, np.finfo(float).tiny)
    if _area(points + _TRIED * hole * way) < (1 - _TRIED / 4) * _area(points):
        width = min(width, _OF_HOLE * hole)
    steps = [width * (k + 1) / strips for k in range(strips)]
    return [_rounded(points + step * way, step / (length / len(points))) for step in steps]


def _rounded(ring: Floats, edges: float) -> Floats:
    """A ring with each point averaged with those beside it, over about so many edges either way."""
    for _ in range(min(int(edges**2), _MOST_ROUNDS)):
        ring = ring / 2 + (np.roll(ring, 1, axis=0) + np.roll(ring, -1, axis=0)) / 4
    return ring


def _outward(mesh: Polyhedron, loop: Loop, rounds: int) -> Floats:
    """Directions away from the faces at the vertices of a loop, (n, 3), longer at corners, that offset its edges by 1.

    Averaged along the loop so many times.
    """
    h = loop.halfedges
    along = mesh.vertices[mesh.head[h]] - mesh.vertices[mesh.tail[h]]
    across = _unit(np.cross(along, vector_areas(mesh)[mesh.face[h]]))
    for _ in range(rounds):
        across = _unit(across / 2 + (np.roll(across, 1, axis=0) + np.roll(across, -1, axis=0)) / 4)
    both = across + np.roll(across, 1, axis=0)
    return np.asarray(both / np.maximum((both**2).sum(axis=1) / 2, 0.5)[:, None])


def _strip(inner: Ints, outer: Ints) -> Ints:
    """The triangles between two rings of as many vertices; those on the inner one first."""
    following, beyond = np.roll(inner, -1), np.roll(outer, -1)
    low = np.stack([following, inner, outer], axis=1)
    return np.concatenate([low, np.stack([following, outer, beyond], axis=1)])


def _cap(ring: Floats, number: Ints) -> tuple[Floats, Ints]:
    """Rings of half as many vertices each, and a middle at last; triangles at the edges of the first ring in order."""
    middle = ring.mean(axis=0)
    points: list[Floats] = []
    triangles: list[Ints] = []
    following = int(number[-1]) + 1
    while len(number) > _FEW:
        ring = _shrunk(ring, middle)
        inner = following + np.arange(len(ring))
        triangles.append(_halving(number, inner))
        points.append(ring)
        number, following = inner, following + len(ring)
    triangles.append(np.stack([np.roll(number, -1), number, np.full(len(number), following)], axis=1))
    return np.concatenate([*points, middle[None]]), np.concatenate(triangles)


def _shrunk(ring: Floats, middle: Floats) -> Floats:
    """Every second point of a ring, moved to the middle by the mean length of its edges, half way at most."""
    radius = max(float(np.linalg.norm(ring - middle, axis=1).mean()), np.finfo(float).tiny)
    step = min(_around(ring) / len(ring) / radius, 0.5)
    return np.asarray(ring[::2] + step * (middle - ring[::2]))


def _halving(outer: Ints, inner: Ints) -> Ints:
    """The triangles between a ring and one of half as many vertices, rounded up; those on the outer one first.

    Vertex k of the inner ring is opposite to vertex 2k of the outer one.
    """
    place = np.arange(len(outer))
    apex = inner[(place + 1) // 2 % len(inner)]
    base = np.stack([np.roll(outer, -1), outer, apex], axis=1)
    odd = np.arange(1, len(outer), 2)
    turned = np.stack([outer[odd], inner[odd // 2], inner[(odd + 1) // 2 % len(inner)]], axis=1)
    if len(outer) % 2:
        turned = np.concatenate([turned, [[outer[0], inner[-1], inner[0]]]])
    return np.concatenate([base, turned])


def _glued(mesh: Polyhedron, loops: list[Loop], patches: list[tuple[Floats, Ints]]) -> Polyhedron:
    """The mesh with the triangles of patches glued to its loops."""
    vertices, tails = [mesh.vertices], [mesh.tail]
    twins, same = [mesh.twin.copy()], [mesh.same.copy()]
    for loop, (points, triangles) in zip(loops, patches, strict=True):
        first_vertex, first = sum(map(len, vertices)), sum(map(len, tails))
        own = np.concatenate([loop.vertices, first_vertex + np.arange(len(points))])
        twin = Polyhedron.from_faces(np.zeros((len(own), 3)), triangles).twin
        twin[twin >= 0] += first
        base = 3 * np.arange(len(loop.vertices))
        twin[base], twins[0][loop.halfedges] = loop.halfedges, first + base
        backward = np.zeros(len(twin), dtype=np.bool_)
        backward[base] = same[0][loop.halfedges] = ~loop.forward(mesh)
        vertices.append(points)
        tails.append(own[triangles].ravel())
        twins.append(twin)
        same.append(backward)
    added = sum(len(triangles) for _, triangles in patches)
    offsets = np.concatenate([mesh.offsets, mesh.offsets[-1] + 3 * (1 + np.arange(added))])
    tail, twin, backward = np.concatenate(tails), np.concatenate(twins), np.concatenate(same)
    return Polyhedron(np.concatenate(vertices), offsets, tail, twin, backward, unit=mesh.unit)


def _doubled(mesh: Polyhedron) -> Polyhedron:
    """The mesh and a reversed copy of it, glued along its boundary."""
    copy = reversed_faces(mesh, np.ones(mesh.face_count, dtype=np.bool_))
    start, size = mesh.offsets[:-1][mesh.face], mesh.face_sizes[mesh.face]
    index, count = np.arange(len(mesh.tail)), len(mesh.tail)
    mirrored = start + (size - 1 - (index - start))
    open_ = np.flatnonzero(mesh.twin < 0)
    inside = np.ones(len(mesh.vertices), dtype=np.bool_)
    inside[mesh.tail[open_]] = False
    number = np.where(inside, len(mesh.vertices) + np.cumsum(inside) - 1, np.arange(len(mesh.vertices)))
    twin = np.concatenate([mesh.twin, np.where(copy.twin < 0, -1, copy.twin + count)])
    twin[open_], twin[count + mirrored[open_]] = count + mirrored[open_], open_
    return replace(
        mesh,
        vertices=np.concatenate([mesh.vertices, mesh.vertices[inside]]),
        offsets=np.concatenate([mesh.offsets, mesh.offsets[1:] + count]),
        tail=np.concatenate([mesh.tail, number[copy.tail]]),
        twin=twin,
        same=np.concatenate([mesh.same, copy.same]),
    )


def _around(ring: Floats) -> float:
    """The length of a closed chain of points."""
    return float(np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1).sum())


def _area(ring: Floats) -> float:
    """The area of a closed chain of points, seen from where it is largest."""
    centred = ring - ring.mean(axis=0)
    return float(np.linalg.norm(np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0))) / 2


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, np.finfo(float).tiny))
