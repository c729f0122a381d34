"""Gluing of patches: which sides of polygonal patches are one edge, which way they run, and outward orientation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Points of a triangle nearer than this, in its barycentric coordinates, are one corner of its micro triangles.
_NEAR = 1e-7


class Gluing(NamedTuple):
    """The other side of the edge at each side k p + c of patches with k corners: side c runs from corner c to c + 1.

    twin: (k N,); same: (k N,), the twin runs the same way, as somewhere on every nonorientable surface.
    """

    twin: Ints
    same: Bools

    def corner_classes(self, corners: int) -> Ints:
        """The vertex at every corner of patches with so many corners, (k N,), by numbers from 0."""
        side = np.arange(len(self.twin))
        after, beyond = _following(side, corners), _following(self.twin, corners)
        start, end = np.where(self.same, self.twin, beyond), np.where(self.same, beyond, self.twin)
        return _components(np.concatenate([side, after]), np.concatenate([start, end]), len(side))


def alike(twin: Ints, same: Bools) -> Ints:
    """1 or -1 for every triangle, (F,): all run alike when those with -1 are turned round; 1 if they never can."""
    count = len(twin) // 3
    face, other = np.arange(len(twin)) // 3, twin // 3
    here = np.concatenate([face, face + count])
    there = np.concatenate([other + count * same, other + count * ~same])
    sheet = _components(here, there, 2 * count)
    if sheet[0] == sheet[count]:
        return np.ones(count, dtype=np.intp)
    return np.where(sheet[:count] == sheet[0], 1, -1)


def micro_gluing(domain: GeodesicTriangulation, micro_triangles: Floats, sign: Ints) -> Gluing:
    """How micro triangles are glued: inside of the triangles by their corners, across edges as the triangles are.

    micro_triangles: (F, m, 3, 3), counterclockwise in the frame of the triangle where its sign is 1, clockwise where it
    is -1.
    """
    count = micro_triangles.shape[1]
    place = micro_triangles @ np.linalg.inv(domain.corners)[:, None]
    place = (place / place.sum(axis=-1, keepdims=True)).reshape(len(micro_triangles), 3 * count, 3)
    near = np.abs(place[:, :, None] - place[:, None]).max(axis=-1) < _NEAR
    corner = near.argmax(axis=2)
    following = _following(np.arange(3 * count), 3)
    ends = np.sort(np.stack([corner, corner[:, following]], axis=2), axis=2)
    key = ((np.arange(len(micro_triangles))[:, None] * 3 * count + ends[..., 0]) * 3 * count + ends[..., 1]).ravel()
    twin = _paired(key)
    same = np.zeros(len(twin), dtype=np.bool_)
    middle = ((place + place[:, following]) / 2).reshape(-1, 3)
    outer = np.flatnonzero(twin < 0)
    edge = 3 * (outer // (3 * count)) + (middle[outer].argmin(axis=1) + 1) % 3
    outer = outer[np.lexsort((middle[outer, (edge + 1) % 3], edge))]
    edge = np.sort(edge)
    rank, number = _ranks(edge, len(domain.twin))
    beyond = domain.twin[edge]
    mirrored = np.where(domain.same[edge], rank, number[edge] - 1 - rank)
    first = np.concatenate([[0], np.cumsum(number)])
    twin[outer] = outer[first[beyond] + mirrored]
    same[outer] = domain.same[edge] ^ (sign[edge // 3] < 0) ^ (sign[beyond // 3] < 0)
    return Gluing(twin, same)


def quartered(gluing: Gluing) -> Gluing:
    """The gluing of the three quadrilaterals of each triangle, 3 p + c at corner c, from that of the triangles.

    Their sides: to the middle of the edge after the corner, to the centroid, to the middle of the edge before, back.
    """
    triangle, c = np.divmod(np.arange(len(gluing.twin)), 3)
    quad, next_quad = 4 * (3 * triangle + c), 4 * (3 * triangle + (c + 1) % 3)
    twin, same = np.empty(4 * len(quad), dtype=np.intp), np.zeros(4 * len(quad), dtype=np.bool_)
    twin[quad + 1], twin[next_quad + 2] = next_quad + 2, quad + 1
    start, end = quad, next_quad + 3
    twin[start] = np.where(gluing.same, start[gluing.twin], end[gluing.twin])
    twin[end] = np.where(gluing.same, end[gluing.twin], start[gluing.twin])
    same[start] = same[end] = gluing.same
    return Gluing(twin, same)


def periodic_grid(pieces: tuple[int, int], mirror: Ints | None) -> Gluing:
    """The gluing of a grid of quadrilaterals, nv i + j, whose ends meet in both directions.

    Side 0 runs along u, side 1 along v. mirror: (nv,), the piece that lies beyond the last u at each v, seen upside
    down, as on a Klein bottle; None on a torus.
    """
    nu, nv = pieces
    i, j = np.divmod(np.arange(nu * nv), nv)
    twin, same = np.empty((nu * nv, 4), dtype=np.intp), np.zeros((nu * nv, 4), dtype=np.bool_)
    above = nv * i + (j + 1) % nv
    twin[:, 2], twin[above, 0] = 4 * above, 4 * np.arange(nu * nv) + 2
    same[:, 1] = (i == nu - 1) & (mirror is not None)
    beyond = nv * ((i + 1) % nu) + np.where(same[:, 1], j if mirror is None else mirror[j], j)
    twin[:, 1], twin[beyond, 3] = 4 * beyond + 3, 4 * np.arange(nu * nv) + 1
    same[beyond, 3] = same[:, 1]
    return Gluing(twin.ravel(), same.ravel())


def _following(side: Ints, corners: int) -> Ints:
    return np.asarray(side - side % corners + (side + 1) % corners)


def _components(first: Ints, second: Ints, count: int) -> Ints:
    graph = coo_array((np.ones(len(first), dtype=np.int8), (first, second)), shape=(count, count))
    return connected_components(graph, directed=False)[1].astype(np.intp)


def _paired(key: Ints) -> Ints:
    """The other place with the same key, -1 where there is none."""
    order = np.argsort(key, kind="stable")
    pair = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    twin = np.full(len(key), -1, dtype=np.intp)
    twin[order[pair]], twin[order[pair + 1]] = order[pair + 1], order[pair]
    return twin


def _ranks(group: Ints, count: int) -> tuple[Ints, Ints]:
    """The place of each entry in its group, for sorted groups, and the sizes of all groups (count,)."""
    number = np.bincount(group, minlength=count)
    return np.arange(len(group)) - np.repeat(np.cumsum(number) - number, number), number
