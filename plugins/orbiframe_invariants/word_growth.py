"""Elements of a group by the lengths of their shortest words in the side pairings, and how their number grows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from orbiframe import FundamentalPolygon, GeometryError
from orbiframe.groups import Elements, Generators, PolygonGroup, grown_elements, lettered_pairings
from orbiframe.planes import PreciseIsometry

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_STRAIGHT = 1e-9
# Matrices that agree to this, relative to their size, are one; none may be nearer to another than a hundred times this.
_SAME = 1e-10
_MOST = 100_000_000


def elements_by_length(group: PolygonGroup, length: int, *, most: int = _MOST) -> Elements:
    """Every element that is a word of at most `length` side pairings, each once, shorter ones first.

    The depth of an element in the result is the length of its shortest word. Where the sides of all tiles make up whole
    lines (`even_corners`), the length is the number of lines between the two tiles, and whoever crosses a side beyond
    which the origin lies leaves one behind; so the tree of `elements_within` does, with heights over the sides. For
    other polygons the products of each length are compared with those before. Raises GeometryError where rounding
    decides, or where there are more than `most` elements.
    """
    precise, letters = lettered_pairings(group)
    steps = Generators(group.geometry, precise, tuple(letters), np.array(group.word.mate))
    if even_corners(group.polygon):
        return grown_elements(steps, -group.polygon.sides, len(letters), np.inf, length, 1000, most)
    return _searched(steps, length, most)


def growth_series(group: PolygonGroup, length: int) -> tuple[int, ...]:
    """How many elements have shortest words of 0, 1, ..., `length` side pairings."""
    return tuple(map(int, np.bincount(elements_by_length(group, length).depth, minlength=length + 1)))


def even_corners(polygon: FundamentalPolygon) -> bool:
    """Whether the sides of the tiles make up whole lines: half of the corners round every vertex add up to pi.

    So it is for regular polygons with an even number of corners round each vertex, and for parallelograms.
    """
    angles = polygon.interior_angles
    for cycle in polygon.word.vertex_cycles:
        half, odd = divmod(len(cycle), 2)
        doubled = np.concatenate([angles[list(cycle)]] * 2)
        sums = [doubled[k : k + half].sum() for k in range(len(cycle))]
        if odd or np.abs(np.array(sums) - np.pi).max() > _STRAIGHT * len(angles):
            return False
    return True


def _searched(steps: Generators, length: int, most: int) -> Elements:
    """Level by level: a product of an element of length k has length k - 1, k or k + 1."""
    k, count = steps.geometry.curvature, len(steps.mate)
    first = PreciseIsometry.of_matrix(k, np.eye(3)[None])
    spins, parents, letters = [first], [np.array([-1])], [np.array([-1])]
    start, level, before = 0, first, first[np.zeros(0, dtype=np.intp)]
    for _ in range(length):
        row, step = np.divmod(np.arange(len(level.a) * count), count)
        products = level[row] @ steps.precise[step]
        new = _new(PreciseIsometry.joined([before, level]), products)
        before, level = level, products[new]
        spins, parents, letters = [*spins, level], [*parents, start + row[new]], [*letters, step[new]]
        start += len(before.a)
        if start + len(level.a) > most:
            raise GeometryError(f"there are more than {most} elements; ask for fewer, or raise most")
    every = PreciseIsometry.joined(spins)
    a, b = (part.astype(np.complex128) for part in (every.a, every.b))
    return Elements(
        steps, a, b, every.reverses, np.concatenate(parents).astype(np.int32), np.concatenate(letters).astype(np.int16)
    )


def _new(known: PreciseIsometry, products: PreciseIsometry) -> Ints:
    """The products that are not known, each once."""
    flat = PreciseIsometry.joined([known, products]).matrix.reshape(-1, 9)
    tree = cKDTree(flat / np.abs(flat).max(axis=1, keepdims=True))
    pairs = tree.query_pairs(_SAME, p=np.inf, output_type="ndarray")
    if len(tree.query_pairs(100 * _SAME, p=np.inf, output_type="ndarray")) > len(pairs):
        raise GeometryError("rounding decides whether two elements are one; ask for shorter words")
    repeated = np.zeros(len(flat), dtype=np.bool_)
    repeated[pairs.max(axis=1)] = True
    return np.flatnonzero(~repeated[len(known.a) :])
