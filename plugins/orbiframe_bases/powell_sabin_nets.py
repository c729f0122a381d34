"""The Bernstein coefficients of Powell-Sabin splines of degrees 2 to 6 on the split of a triangle in six.

With jets of order k at the vertices and degree d, let e = 2 (d - k) - 1 and w = d - e, and B the blossom. On an edge
from v_i to v_j through R, for m < w, the form B(R^(w - m), Z^m, u^e) is one polynomial in u = s v_i + t v_j; half of
its coefficients come from the jet of v_i, half from that of v_j. In the whole triangle B(Z^w, u^e) is one polynomial in
u; its coefficients with d - k or more arguments v_i come from the jet of v_i. Subdivided at Z and R, these polynomials
give the coefficients on (v, R, Z).
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.splines import coefficient_count, exponents, polar

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_NEXT = np.array([1, 2, 0])


class Pieces(NamedTuple):
    """What the nets of N triangles are made of; whatever belongs to corner or edge c has the order c, c + 1, c + 2.

    jets: (N, 3, n_k, m), the jet of every corner on the triangle as forms of its m unknowns; centre: (N, 3, 3), the
    coordinates of Z, rotated for every corner; share: (N, 3, 2), R = mu v_c + nu v_(c + 1); normals: (N, 3, 3), the
    coordinates of normals of the edges (degree 6 only).
    """

    jets: Floats
    centre: Floats
    share: Floats
    normals: Floats


def powell_sabin_nets(degree: int, order: int, pieces: Pieces, unknowns: int) -> Floats:
    """The coefficients on the six micro triangles as forms of the local unknowns, (N, 6, n_d, unknowns).

    order: k, that of the jets. The unknowns stand as in `Unknowns`: the jets of the corners, then one for every edge
    (degree 6) or one for the triangle (degrees 4 and 5).
    """
    fixed = 2 * order - degree + 1
    nets = np.empty((len(pieces.jets), 3, 2, coefficient_count(degree), unknowns))
    jets = _spread(pieces.jets, unknowns)
    lines = []
    for m in range(fixed):
        lines.append(_fill_from_jets(nets, m, fixed, jets, order - m, pieces.share))
        jets = polar(jets, pieces.centre)
    central = _central(degree - order, jets)
    if degree == 6:
        _add_edge_unknowns(central, lines[0], pieces)
    elif degree > 3:
        central[:, _number((1, 1, 1)), -1] = 1
    for m in range(fixed, degree + 1):
        _fill_row(nets, m, 0, central[:, _edge_numbers(degree - m)], pieces.share)
        if m < degree:
            central = polar(central, pieces.centre[:, 0])
    return nets.reshape(len(nets), 6, -1, unknowns)


def _spread(jets: Floats, unknowns: int) -> Floats:
    """The jets as forms of all unknowns of their triangle, (N, 3, n_k, unknowns)."""
    width = jets.shape[3]
    spread = np.zeros((*jets.shape[:3], unknowns))
    for c in range(3):
        spread[:, c, :, width * c : width * (c + 1)] = jets[:, c]
    return spread


def _fill_from_jets(nets: Floats, m: int, fixed: int, jets: Floats, degree: int, share: Floats) -> Floats:
    """The coefficients with m < w arguments Z, from jets with m arguments Z; returns B(R^(w - m), Z^m, u^e)."""
    start = jets[:, :, [_number_in_micro(s, 0) for s in range(degree + 1)]]
    end = jets[:, _NEXT][:, :, [_number_in_micro(0, s) for s in range(degree, -1, -1)]]
    for s in range(fixed - m):
        nets[:, :, 0, _number_in_micro(s, m)], nets[:, :, 1, _number_in_micro(s, m)] = start[:, :, 0], end[:, :, -1]
        start, end = _edge_polar(start, share), _edge_polar(end, share)
    line = np.concatenate([start, end], axis=2)
    _fill_row(nets, m, fixed - m, line, share)
    return line


def _fill_row(nets: Floats, m: int, first: int, line: Floats, share: Floats) -> None:
    """The coefficients with m arguments Z and `first` or more arguments R, by subdivision of polynomials at R.

    line: (N, 3, t + 1, unknowns), coefficient s on edge c with t - s arguments v_c and s arguments v_(c + 1).
    """
    for s in range(first, first + line.shape[2]):
        number = _number_in_micro(s, m)
        nets[:, :, 0, number], nets[:, :, 1, number] = line[:, :, 0], line[:, :, -1]
        line = _edge_polar(line, share)


def _edge_polar(line: Floats, weights: Floats) -> Floats:
    """One argument on every edge fixed, with coordinates (N, 3, 2) on it: one step of de Casteljau."""
    return np.asarray(weights[..., 0, None, None] * line[:, :, :-1] + weights[..., 1, None, None] * line[:, :, 1:])


def _edge_values(line: Floats, weights: Floats, times: int) -> Floats:
    """The same argument fixed several times; the form that is left, or the only coefficient where nothing is left."""
    for _ in range(times):
        line = _edge_polar(line, weights)
    return line if line.shape[2] > 1 else line[:, :, 0]


def _central(equal: int, jets: Floats) -> Floats:
    """B(Z^w, u^e) on the triangle, (N, n_e, unknowns), from jets with w arguments Z; what they leave open is zero.

    equal: d - k, how many arguments v_c the jets of corner c stand for.
    """
    central = np.zeros((len(jets), coefficient_count(2 * equal - 1), jets.shape[3]))
    for c in range(3):
        for n, a in enumerate(exponents(equal - 1)):
            central[:, _number((equal + a[0], a[1], a[2]), c)] = jets[:, c, n]
    return central


def _add_edge_unknowns(central: Floats, line: Floats, pieces: Pieces) -> None:
    """The coefficients (2, 2, 1) of p(u) = B(Z, u^5) from the second derivatives B(R^4, n, n) along the normals n.

    n = a v_i + b v_j + c Z, and 6 mu^2 nu^2 z_k c^2 is the share of the coefficient in B(R^4, n, n). line: B(R, u^5).
    """
    share, z = pieces.share, pieces.centre
    c = (pieces.normals[..., 2] / z[..., 2])[..., None]
    along = pieces.normals[..., :2] - c * z[..., :2]
    p = central[:, _edge_numbers(5)]
    to_third = central[:, [[_number((4 - s, s, 1), e) for s in range(5)] for e in range(3)]]
    at_z = _edge_values(p, share, 4)
    beside = _edge_polar(at_z, z)[:, :, 0] + z[..., 2:] * _edge_values(to_third, share, 4)
    known = _edge_values(_edge_values(line, share, 3), along, 2)
    known += 2 * c * _edge_polar(at_z, along)[:, :, 0] + c**2 * beside
    factor = 6 * c**2 * z[..., 2:] * np.prod(share, axis=-1, keepdims=True) ** 2
    for e in range(3):
        known[:, e, e - 3] -= 1
        central[:, _number((2, 2, 1), e)] = -known[:, e] / factor[:, e]


def _number_in_micro(s: int, m: int) -> int:
    """The number of the exponent with s arguments R and m arguments Z."""
    return (s + m) * (s + m + 1) // 2 + m


def _number(exponent: tuple[int, int, int], corner: int = 0) -> int:
    """The number of an exponent that is given in the order corner, corner + 1, corner + 2."""
    _, second, third = (exponent[(i - corner) % 3] for i in range(3))
    return _number_in_micro(second, third)


@lru_cache(maxsize=16)
def _edge_numbers(degree: int) -> Ints:
    """The numbers of the coefficients on the edges, (3, degree + 1)."""
    return np.array([[_number((degree - s, s, 0), c) for s in range(degree + 1)] for c in range(3)])
