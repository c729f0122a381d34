"""Closed triangle meshes that are hard to map: handles, fingers, slivers, needles, high and low valences, plates."""

from __future__ import annotations

from itertools import product

import numpy as np

from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.subdivision import refine

Cell = tuple[int, int, int]


def voxels(cells: set[Cell], density: int = 1) -> Polyhedron:
    """The surface of a solid of unit cubes, every square cut in two and every triangle into density^2."""
    quads = []
    for cell in sorted(cells):
        for axis, side in product(range(3), (0, 1)):
            beyond = list(cell)
            beyond[axis] += 2 * side - 1
            if tuple(beyond) not in cells:
                quads.append(_square(np.array(cell), axis, side))
    corners, index = np.unique(np.array(quads).reshape(-1, 3), axis=0, return_inverse=True)
    mesh = triangulated(Polyhedron.from_faces(corners.astype(float), index.reshape(-1, 4)))
    return refine(mesh, density).polyhedron


def _square(cell: np.ndarray, axis: int, side: int) -> np.ndarray:
    """The corners of one square of a cube, counterclockwise from outside."""
    u, v = np.eye(3, dtype=int)[[(axis + 1) % 3, (axis + 2) % 3]]
    base = cell + side * np.eye(3, dtype=int)[axis]
    ring = np.stack([base, base + u, base + u + v, base + v])
    return ring if side else ring[::-1]


def plate_cells(rows: int, columns: int) -> set[Cell]:
    """A plate one cube thick with rows by columns square holes."""
    grid = product(range(2 * rows + 1), range(2 * columns + 1))
    return {(i, j, 0) for i, j in grid if not (i % 2 and j % 2)}


def plate(rows: int, columns: int, density: int = 1) -> Polyhedron:
    """The surface of genus rows * columns."""
    return voxels(plate_cells(rows, columns), density)


def handles(genus: int, density: int = 1) -> Polyhedron:
    """A plate with as many holes as its genus, in as square an array as it divides into; a cube for genus 0."""
    if genus == 0:
        return voxels({(0, 0, 0)}, 3 * density)
    rows = max(r for r in range(1, int(genus**0.5) + 1) if genus % r == 0)
    return plate(rows, genus // rows, density)


def with_finger(cells: set[Cell], root: Cell, ratio: float, density: int = 3) -> Polyhedron:
    """A solid with a finger upon one of its cubes; ratio: its length over the radius of a circle of the same girth."""
    x, y, z = root
    length = round(ratio * 2 / np.pi)
    return voxels(cells | {(x, y, z + k) for k in range(1, length + 1)}, density)


def with_slivers(mesh: Polyhedron, share: float, depth: float, rounds: int, seed: int = 0) -> Polyhedron:
    """Random faces cut in three from a point at a distance of depth times the height from one of their sides."""
    rng = np.random.default_rng(seed)
    vertices, faces = mesh.vertices, mesh.triangles
    for _ in range(rounds):
        chosen = rng.permutation(len(faces))[: max(1, int(share * len(faces)))]
        corners = np.take_along_axis(faces[chosen], (np.arange(3) + rng.integers(3, size=(len(chosen), 1))) % 3, 1)
        along = rng.uniform(0.2, 0.8, size=len(chosen)) * (1 - depth)
        weights = np.stack([along, 1 - depth - along, np.full(len(chosen), depth)], axis=1)
        fresh = len(vertices) + np.arange(len(chosen))
        vertices = np.concatenate([vertices, np.einsum("fc,fci->fi", weights, vertices[corners])])
        a, b, c = corners.T
        parts = [np.stack(part, axis=1) for part in ((a, b, fresh), (b, c, fresh), (c, a, fresh))]
        faces = np.concatenate([np.delete(faces, chosen, axis=0), *parts])
    return Polyhedron.from_faces(vertices, faces)


def with_fan(mesh: Polyhedron, halfedge: int, count: int) -> Polyhedron:
    """So many vertices on one edge, joined to the two vertices opposite to it."""
    twin = int(mesh.twin[halfedge])
    a, b = int(mesh.tail[halfedge]), int(mesh.head[halfedge])
    apexes = [int(mesh.tail[mesh.next[mesh.next[h]]]) for h in (halfedge, twin)]
    share = (np.arange(1, count + 1) / (count + 1))[:, None]
    points = (1 - share) * mesh.vertices[a] + share * mesh.vertices[b]
    chain = np.array([a, *(len(mesh.vertices) + np.arange(count)), b])
    left = np.stack([chain[:-1], chain[1:], np.full(count + 1, apexes[0])], axis=1)
    right = np.stack([chain[1:], chain[:-1], np.full(count + 1, apexes[1])], axis=1)
    rest = np.delete(mesh.triangles, [mesh.face[halfedge], mesh.face[twin]], axis=0)
    return Polyhedron.from_faces(np.concatenate([mesh.vertices, points]), np.concatenate([rest, left, right]))


def stretched(mesh: Polyhedron, *factors: float) -> Polyhedron:
    return mesh.with_vertices(mesh.vertices * np.array(factors))


def with_many_of_valence_three(mesh: Polyhedron, rounds: int = 1) -> Polyhedron:
    """A vertex in the middle of every face, joined to its corners."""
    for _ in range(rounds):
        middles = mesh.vertices[mesh.triangles].mean(axis=1)
        fresh = len(mesh.vertices) + np.arange(mesh.face_count)
        a, b, c = mesh.triangles.T
        parts = [np.stack(part, axis=1) for part in ((a, b, fresh), (b, c, fresh), (c, a, fresh))]
        mesh = Polyhedron.from_faces(np.concatenate([mesh.vertices, middles]), np.concatenate(parts))
    return mesh


def with_notched_edges(mesh: Polyhedron, depth: float = 0.1, seed: int = 0) -> Polyhedron:
    """Every triangle a hexagon: a vertex of valence 2 near the middle of every edge, moved at random by depth edges."""
    rng = np.random.default_rng(seed)
    edges = np.flatnonzero(mesh.representative)
    middle = (mesh.vertices[mesh.tail[edges]] + mesh.vertices[mesh.head[edges]]) / 2
    middle += depth * mesh.edge_lengths[edges, None] * rng.normal(size=middle.shape)
    corners = np.stack([mesh.tail, len(mesh.vertices) + mesh.edge], axis=1).reshape(-1, 6)
    return Polyhedron.from_faces(np.concatenate([mesh.vertices, middle]), corners)


def hurwitz(p: int, seed: int = 0) -> Polyhedron:
    """A regular map {3, 7} with the group PSL(2, p): genus 3, 14, 146 for p = 7, 13, 29; its vertices lie anywhere.

    Its halfedges are the elements of the group: `next` multiplies by an element of order 3 from the right, `twin` by
    one of order 2, and their product has order 7.
    """
    group = _psl2(p)
    number = {element: i for i, element in enumerate(group)}
    two = next(g for g in group if g != (1, 0, 0, 1) and _times(g, g, p) == (1, 0, 0, 1))
    three = next(g for g in group if _order(g, p) == 3 and _order(_times(two, g, p), p) == 7 and _generates(two, g, p))
    following, twin = (np.array([number[_times(g, s, p)] for g in group]) for s in (three, two))
    vertex = _cycles(twin[following[following]])
    seen, faces = np.zeros(len(group), dtype=bool), []
    for h in range(len(group)):
        if not seen[h]:
            face = [h, following[h], following[following[h]]]
            seen[face] = True
            faces.append(vertex[face])
    count = int(vertex.max()) + 1
    return Polyhedron.from_faces(np.random.default_rng(seed).normal(size=(count, 3)), np.array(faces))


def _psl2(p: int) -> list[tuple[int, ...]]:
    rows = [(a, b, c, d) for a, b, c in product(range(p), repeat=3) for d in _last(a, b, c, p)]
    return sorted({_canonical(row, p) for row in rows})


def _last(a: int, b: int, c: int, p: int) -> list[int]:
    if a:
        return [(1 + b * c) * pow(a, -1, p) % p]
    return list(range(p)) if (b * c + 1) % p == 0 else []


def _canonical(matrix: tuple[int, ...], p: int) -> tuple[int, ...]:
    # Of g and -g the one that starts with the smaller number; the identity stays (1, 0, 0, 1).
    return min(tuple(x % p for x in matrix), tuple(-x % p for x in matrix))


def _times(g: tuple[int, ...], h: tuple[int, ...], p: int) -> tuple[int, ...]:
    a, b, c, d = g
    e, f, i, j = h
    return _canonical((a * e + b * i, a * f + b * j, c * e + d * i, c * f + d * j), p)


def _order(g: tuple[int, ...], p: int) -> int:
    power, order = g, 1
    while power != (1, 0, 0, 1):
        power, order = _times(power, g, p), order + 1
    return order


def _generates(g: tuple[int, ...], h: tuple[int, ...], p: int) -> bool:
    """Whether the subgroup of g and h is all of PSL(2, p)."""
    found, queue = {(1, 0, 0, 1)}, [(1, 0, 0, 1)]
    while queue:
        here = queue.pop()
        for step in (g, h):
            there = _times(here, step, p)
            if there not in found:
                found.add(there)
                queue.append(there)
    return 2 * len(found) == p * (p * p - 1)


def _cycles(permutation: np.ndarray) -> np.ndarray:
    label = np.full(len(permutation), -1)
    count = 0
    for start in range(len(permutation)):
        if label[start] < 0:
            here = start
            while label[here] < 0:
                label[here] = count
                here = permutation[here]
            count += 1
    return label


def crosscaps(count: int, density: int = 1) -> Polyhedron:
    """The connected sum of so many projective planes of 6 vertices, joined along triangles, its vertices anywhere."""
    cap = [[0, i, i % 5 + 1] for i in range(1, 6)]
    rim = [[i, i % 5 + 1, (i + 2) % 5 + 1] for i in range(1, 6)]
    plane, faces = cap + rim, cap + rim
    for _ in range(count - 1):
        size = max(map(max, faces)) + 1
        names = dict(zip(plane[0], reversed(faces[-1]), strict=True))
        names |= {corner: size + k for k, corner in enumerate(sorted(set(range(6)) - set(plane[0])))}
        faces = faces[:-1] + [[names[corner] for corner in face] for face in plane[1:]]
    size = max(map(max, faces)) + 1
    vertices = np.random.default_rng(count).normal(size=(size, 3))
    return refine(Polyhedron.from_faces(vertices, faces), density).polyhedron
