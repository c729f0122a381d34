"""Corner elements: the isometries that take one corner of a polygon to the corners glued to it, with all digits."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.groups.fundamental_polygon import FundamentalPolygon
from orbiframe.groups.group import Group
from orbiframe.planes.precise_isometry import PreciseIsometry
from orbiframe.words.word import Word

Ints = NDArray[np.intp]


def corner_elements(polygon: FundamentalPolygon) -> PreciseIsometry:
    """For every corner c of a polygon whose word has one vertex the group element g_c with g_c P_0 = P_c, (n,).

    The tiles round P_0 are F seen from its corners one after the other, in the order of the vertex cycle, so that
    g_c^-1 F takes up the angle after those before it. Hence g_c = flag at P_c times the inverse of a flag at P_0:
    no product of side pairings is formed, and no error grows along the cycle.
    """
    k = polygon.geometry.curvature
    cycle, crossed = (
        np.array(row, dtype=np.intp) for row in (polygon.word.vertex_cycles[0], polygon.word.relations[0])
    )
    corner = PreciseIsometry.translation(k, polygon.vertices)
    after, before = polygon.directions
    # One leaves a tile across the side before its corner, seen counterclockwise, unless the tile is a mirror image.
    mirrored = crossed == cycle
    angles = np.mod(before - after, 2 * np.pi)[cycle]
    start = after[cycle[0]] + np.cumsum(angles) - angles
    first = np.where(mirrored, before[cycle], after[cycle])
    here = corner[cycle] @ PreciseIsometry.rotation(k, first, mirrored)
    elements = here @ (corner[cycle[0]] @ PreciseIsometry.rotation(k, start)).inverse
    return elements[np.argsort(cycle)]


def products_of_pairings(group: Group) -> PreciseIsometry:
    """The same for any group whose word has one vertex, by products of generators along the vertex cycle."""
    word = group.word
    size, k = len(word), group.geometry.curvature
    steps = {side: PreciseIsometry.of_matrix(k, _pairing(group, side)) for side in range(size)}
    found = {0: PreciseIsometry.of_matrix(k, np.eye(3))}
    waiting = [0]
    while waiting:
        corner = waiting.pop()
        for side, other in _neighbours(word, corner):
            if other not in found:
                found[other] = steps[side] @ found[corner]
                waiting.append(other)
    parts = [found[corner] for corner in range(size)]
    a, b, reverses = (np.array([getattr(part, name) for part in parts]) for name in ("a", "b", "reverses"))
    return PreciseIsometry(k, a, b, reverses)


def _pairing(group: Group, side: int) -> NDArray[np.float64]:
    label = abs(group.word.letters[side])
    generator = group.generator(label)
    return generator if side == group.word.generator_side(label) else group.geometry.inverse(generator)


def _neighbours(word: Word, corner: int) -> list[tuple[int, int]]:
    """The sides s whose pairing h_s takes this corner to another one, with that corner."""
    found = []
    for mate, end in ((corner, 0), (corner - 1, 1)):
        side = word.mate[mate]
        found.append((side, (side + (end if word.reverses(side) else 1 - end)) % len(word)))
    return found
