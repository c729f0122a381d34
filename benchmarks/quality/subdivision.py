"""Subdivision of closed meshes, orientable or not: Loop, Catmull and Clark, modified butterfly, as sparse matrices."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array, vstack

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


class Edges(NamedTuple):
    """Edges of a mesh: their ends (e, 2), the edge of every side of a face, of the shape of the faces."""

    ends: Ints
    of_side: Ints


class Step(NamedTuple):
    """One step of a scheme: the vertices after it by those before, and the faces after it."""

    matrix: csr_array
    faces: Ints


def edges_of(faces: Ints) -> Edges:
    """Side k of a face runs from its corner k to the next one."""
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    ends, index = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    return Edges(ends.astype(np.intp), index.reshape(faces.shape).astype(np.intp))


def _matrix(rows: Ints, columns: Ints, values: Floats | float, shape: tuple[int, int]) -> csr_array:
    values = np.broadcast_to(values, np.broadcast_shapes(rows.shape, columns.shape))
    rows, columns = np.broadcast_to(rows, values.shape), np.broadcast_to(columns, values.shape)
    return csr_array(coo_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=shape))


def neighbours(edges: Edges, count: int) -> csr_array:
    """1 where two vertices share an edge."""
    a, b = edges.ends.T
    return _matrix(np.r_[a, b], np.r_[b, a], 1.0, (count, count))


def _quartered(faces: Ints, edges: Edges, count: int) -> Ints:
    (a, b, c), (ab, bc, ca) = faces.T, (count + edges.of_side).T
    return np.concatenate([np.stack(f, axis=1) for f in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])


def _wings(faces: Ints, edges: Edges, count: int) -> csr_array:
    """For every edge, the vertices of its two triangles that lie opposite to it."""
    return _matrix(edges.of_side, np.roll(faces, 1, axis=1), 1.0, (len(edges.ends), count))


def loop(faces: Ints, count: int) -> Step:
    """Loop's scheme with his own weights (1987)."""
    edges = edges_of(faces)
    near = neighbours(edges, count)
    valence = near.sum(axis=1)
    beta = _loop_weight(valence)
    old = diags_array(1 - valence * beta) + diags_array(beta) @ near
    ends = _matrix(np.arange(len(edges.ends))[:, None], edges.ends, 3 / 8, (len(edges.ends), count))
    fresh = ends + _wings(faces, edges, count) / 8
    return Step(csr_array(vstack([old, fresh])), _quartered(faces, edges, count))


def _loop_weight(valence: Floats) -> Floats:
    return (5 / 8 - (3 / 8 + np.cos(2 * np.pi / valence) / 4) ** 2) / valence


def loop_limit(faces: Ints, count: int) -> csr_array:
    """The limit positions of the vertices under Loop's scheme."""
    near = neighbours(edges_of(faces), count)
    valence = near.sum(axis=1)
    share = 1 / (valence + 3 / (8 * _loop_weight(valence)))
    return csr_array(diags_array(1 - valence * share) + diags_array(share) @ near)


def catmull_clark(faces: Ints, count: int) -> Step:
    """The scheme of Catmull and Clark (1978) on quadrilaterals."""
    return catmull_clark_of_polygons(faces.ravel(), np.full(len(faces), 4), count)


def catmull_clark_of_polygons(tail: Ints, size: Ints, count: int) -> Step:
    """The same on faces of any sizes, their corners one after another: quadrilaterals come out."""
    face, start = np.repeat(np.arange(len(size)), size), np.repeat(np.cumsum(size) - size, size)
    turn = np.arange(len(tail)) - start
    ahead, before = start + (turn + 1) % size[face], start + (turn - 1) % size[face]
    ends, edge = np.unique(np.sort(np.stack([tail, tail[ahead]], axis=1), axis=1), axis=0, return_inverse=True)
    middles = diags_array(1 / size) @ _matrix(face, tail, 1.0, (len(size), count))
    near = neighbours(Edges(ends, edge), count)
    valence = near.sum(axis=1)
    around = _matrix(tail, face, 1.0, (count, len(size)))
    old = diags_array(1 - 2 / valence) + diags_array(1 / valence**2) @ (near + around @ middles)
    halves = _matrix(np.arange(len(ends))[:, None], ends, 1 / 4, (len(ends), count))
    fresh = halves + _matrix(edge, face, 1 / 4, (len(ends), len(size))) @ middles
    quads = np.stack([tail, count + edge, count + len(ends) + face, count + edge[before]], axis=1)
    return Step(csr_array(vstack([old, fresh, middles])), quads)


def catmull_clark_limit(faces: Ints, count: int) -> csr_array:
    """The limit positions: (n^2 v + 4 sum of edge neighbours + sum of diagonal ones) / (n (n + 5)) (Halstead 1993)."""
    near = neighbours(edges_of(faces), count)
    valence = near.sum(axis=1)
    across = _matrix(faces, np.roll(faces, 2, axis=1), 1.0, (count, count))
    return csr_array(diags_array(1 / (valence * (valence + 5))) @ (diags_array(valence**2) + 4 * near + across))


def butterfly(faces: Ints, count: int) -> Step:
    """The modified butterfly scheme of Zorin, Schroeder and Sweldens (1996)."""
    edges = edges_of(faces)
    valence = neighbours(edges, count).sum(axis=1).astype(int)
    regular = (valence[edges.ends] == 6).all(axis=1)
    rows = [_butterfly_rows(faces, edges, count, np.flatnonzero(regular))]
    rows.append(_irregular_rows(faces, edges, valence, np.flatnonzero(~regular)))
    fresh = csr_array(sum(rows))
    keep = diags_array(np.ones(count))
    return Step(csr_array(vstack([keep, fresh])), _quartered(faces, edges, count))


def _butterfly_rows(faces: Ints, edges: Edges, count: int, which: Ints) -> csr_array:
    """The eight-point rule: ends 1/2, wings 1/8, the wings of the four edges about -1/16."""
    n_edges = len(edges.ends)
    chosen = np.zeros(n_edges)
    chosen[which] = 1
    ends = _matrix(np.arange(n_edges)[:, None], edges.ends, 1.0, (n_edges, count))
    wings = _wings(faces, edges, count)
    others = np.stack([np.roll(edges.of_side, -1, axis=1), np.roll(edges.of_side, 1, axis=1)], axis=2)
    about = _matrix(edges.of_side[..., None], others, 1.0, (n_edges, n_edges))
    # The wings of an edge about it are the far vertex and one end of the edge itself, which is taken out again.
    far = about @ wings - 2 * ends
    return csr_array(diags_array(chosen) @ (ends / 2 + wings / 8 - far / 16))


def _irregular_rows(faces: Ints, edges: Edges, valence: Ints, which: Ints) -> csr_array:
    """The rule about an end whose valence is not 6; the mean of both rules where neither end's is."""
    rings = _Rings(faces[(valence[faces] != 6).any(axis=1)], len(valence))
    rows, columns, values = [], [], []
    for edge in which:
        odd = [(a, b) for a, b in (edges.ends[edge], edges.ends[edge][::-1]) if valence[a] != 6]
        for centre, other in odd:
            ring = rings.ring(int(centre), int(other))
            weights = np.append(_spokes(len(ring)), 0.75) / len(odd)
            rows.append(np.full(len(weights), edge))
            columns.append(np.append(ring, centre))
            values.append(weights)
    shape = (len(edges.ends), len(valence))
    if not rows:
        return csr_array(shape)
    return _matrix(np.concatenate(rows), np.concatenate(columns), np.concatenate(values), shape)


def _spokes(n: int) -> Floats:
    """The weights of the ring, first that of the other end; the centre has 3/4."""
    if n == 3:
        return np.array([5, -1, -1]) / 12
    if n == 4:
        return np.array([3, 0, -1, 0]) / 8
    angle = 2 * np.pi * np.arange(n) / n
    return (1 / 4 + np.cos(angle) + np.cos(2 * angle) / 2) / n


class _Rings:
    """The neighbours of a vertex in their order around it."""

    def __init__(self, faces: Ints, count: int) -> None:
        self.beside: list[dict[int, list[int]]] = [{} for _ in range(count)]
        for triangle in faces.tolist():
            for k in range(3):
                centre, a, b = triangle[k], triangle[k - 2], triangle[k - 1]
                self.beside[centre].setdefault(a, []).append(b)
                self.beside[centre].setdefault(b, []).append(a)

    def ring(self, centre: int, first: int) -> list[int]:
        """From one neighbour all the way round."""
        beside = self.beside[centre]
        ring, last, here = [first], first, beside[first][0]
        while here != first:
            ring.append(here)
            a, b = beside[here]
            last, here = here, (b if a == last else a)
        return ring
