"""Conforming faces: equal knots along strips, so that neighbours have the same functions on their common edge."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from orbiframe_exact.complete_spline import refined
from orbiframe_exact.few_faces import FewFaces
from orbiframe_exact.quad_domain import QuadDomain

Floats = NDArray[np.float64]

Faces = dict[int, tuple[tuple[Floats, Floats], Floats]]


def conforming(found: FewFaces) -> Faces:
    """The same faces with more knots: along a strip, from side to opposite side to neighbour, all have those of all.

    A strip that comes back the other way round has the same knots from both ends.
    """
    breaks = [list(found.faces[q][0]) for q in range(found.domain.count)]
    for strip, closes_turned in strips(found.domain):
        turned = [_turned(breaks[q][axis], back) for q, axis, back in strip]
        common = np.unique(np.concatenate(turned))
        if closes_turned:
            common = np.union1d(common, 1 - common)
        for q, axis, back in strip:
            breaks[q][axis] = _turned(common, back)
    return {q: _refined(found, q, (s, t)) for q, (s, t) in enumerate(breaks)}


def strips(domain: QuadDomain) -> Iterator[tuple[list[tuple[int, int, bool]], bool]]:
    """The strips of quadrilaterals: each as (quadrilateral, axis, whether it runs back), and whether it closes turned.

    Axis 0 of a quadrilateral is s, along its sides 0 and 2, axis 1 is t; they belong to the strips across these sides.
    """
    sides = domain.sides_of_edges()
    known: dict[tuple[int, int], bool] = {}
    for start in ((q, axis) for q in range(domain.count) for axis in (0, 1)):
        if start in known:
            continue
        known[start], waiting, strip, closes_turned = False, [start], [], False
        while waiting:
            q, axis = waiting.pop()
            strip.append((q, axis, known[q, axis]))
            for k in (axis, axis + 2):
                other = next(int(side) for side in sides[domain.edge[q, k]] if side != 4 * q + k)
                there = divmod(other, 4)
                back = known[q, axis] ^ bool(domain.rising[q, k] != domain.rising[there])
                node = there[0], there[1] % 2
                if node not in known:
                    known[node] = back
                    waiting.append(node)
                closes_turned |= known[node] != back
        yield strip, closes_turned


def _turned(breaks: Floats, back: bool) -> Floats:
    return 1 - breaks[::-1] if back else breaks


def _refined(found: FewFaces, quad: int, breaks: tuple[Floats, Floats]) -> tuple[tuple[Floats, Floats], Floats]:
    """A face with more breaks; its border is that of the edges, so that neighbours have the same numbers there."""
    old, poles = found.faces[quad]
    poles = refined(old[0], breaks[0], poles)
    poles = np.swapaxes(refined(old[1], breaks[1], np.swapaxes(poles, 0, 1)), 0, 1).copy()
    for k in range(4):
        edge, rising = found.domain.edge[quad, k], bool(found.domain.rising[quad, k])
        line = refined(found.edge_breaks[edge], _turned(breaks[k % 2], not rising), found.edge_poles[edge])
        line = line if rising else line[::-1]
        outer = -1 if k in (1, 2) else 0
        if k % 2 == 0:
            poles[:, outer] = line
        else:
            poles[outer] = line
    return breaks, poles
