"""The Bernstein coefficients of C^r elements on whole triangles, from jets at the corners and normals of the edges.

For degree d and smoothness r, with d >= 4 r + 1, the jets at the corners have order 2 r. With v_k opposite an edge from
v_i to v_j, row q of the edge holds the coefficients with q arguments v_k: those within distance 2 r of a corner follow
from its jet, the d - 4 r - 1 + q in the middle, for q <= r, from the unknowns B(v_i^s, v_j^t, n^q) with the normal n of
the edge. The coefficients with more than r arguments of each corner are free (Zenisek, 1970; Argyris for r = 1).
"""

from __future__ import annotations

from math import comb
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.splines import Unknowns, coefficient_count, exponents

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


class Corners(NamedTuple):
    """What the nets of N triangles are made of.

    jets: (N, 3, n, n), the jet of corner c on the triangle c, c + 1, c + 2, as forms of its unknowns; normals:
    (N, 3, 3), the coordinates of the normal of edge c in the same order; along: (N, 3), the edge runs as its reference.
    """

    jets: Floats
    normals: Floats
    along: Bools


def unknown_counts(degree: int, smoothness: int) -> tuple[int, int, int]:
    """How many unknowns a vertex, an edge and a triangle have."""
    on_edge = sum(degree - 4 * smoothness - 1 + q for q in range(smoothness + 1))
    return coefficient_count(2 * smoothness), on_edge, comb(degree - 3 * smoothness - 1, 2)


def unsplit_nets(degree: int, smoothness: int, corners: Corners, unknowns: Unknowns) -> Floats:
    """The coefficients as forms of the unknowns of their triangle, (N, n_d, local_size)."""
    nets = np.zeros((len(corners.jets), coefficient_count(degree), unknowns.local_size))
    for c in range(3):
        near = [_number((degree - a[1] - a[2], a[1], a[2]), c) for a in exponents(2 * smoothness)]
        nets[:, near, unknowns.vertex_slots(c)] = corners.jets[:, c]
    inside = np.flatnonzero((exponents(degree) > smoothness).all(axis=1))
    nets[:, inside, unknowns.face_slots] = np.eye(len(inside))
    for edge in range(3):
        _fill_edge(nets, edge, (degree, smoothness), corners, unknowns.edge_slots(edge).start)
    return nets


def _fill_edge(nets: Floats, edge: int, kind: tuple[int, int], corners: Corners, slot: int) -> None:
    """Rows 0 to r of an edge from B(v_i^s, v_j^t, n^q), n = a v_i + b v_j + g v_k.

    B(.., n^q) is the sum over z of q over z times g^z B(.., v_k^z, (a v_i + b v_j)^(q - z)): the last term is the row.
    """
    degree, smoothness = kind
    a, b, g = (corners.normals[:, edge, m, None, None] for m in range(3))
    lower: list[Floats] = []
    for q in range(smoothness + 1):
        numbers = [_number((degree - q - s, s, q), edge) for s in range(degree - q + 1)]
        first, count = 2 * smoothness - q + 1, degree - 4 * smoothness - 1 + q
        free = np.zeros((len(nets), count, nets.shape[2]))
        free[:, np.arange(count), slot + np.arange(count)] = 1
        backwards = np.flatnonzero(~corners.along[:, edge])
        free[backwards] = free[backwards, ::-1]
        known = [comb(q, z) * g**z * row[:, first : first + count] for z, row in enumerate(lower)]
        middle = numbers[first : first + count]
        nets[:, middle] = (free - sum(known)) / g**q if q else free
        lower = [a * row[:, :-1] + b * row[:, 1:] for row in (*lower, nets[:, numbers])]
        slot += count


def _number(exponent: tuple[int, int, int], corner: int) -> int:
    """The number of an exponent that is given in the order corner, corner + 1, corner + 2."""
    _, second, third = (exponent[(i - corner) % 3] for i in range(3))
    return (second + third) * (second + third + 1) // 2 + third
