"""DirichletDomain: the points of X that are nearer to the origin than to all its images under a group."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError, cKDTree

from orbiframe.errors import GeometryError
from orbiframe.groups.group import Group
from orbiframe.planes.geometry import Geometry
from orbiframe.planes.precise_isometry import PreciseIsometry
from orbiframe.words.word import inverse_letters, reduced_letters

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Letters = tuple[int, ...]

_MOST_ROUNDS = 1000
_SAME_AREA = 1e-9
# Elements of a discrete group whose matrices agree to this, relative to their size, are one.
_SAME = 1e-7


@dataclass(frozen=True, eq=False)
class Generators:
    """Elements that generate a group, with their inverses among them: those across the sides of a domain.

    precise: (m,), the elements; letters: m words for them in the letters of the group; mate: (m,), the number of the
    inverse of each.
    """

    geometry: Geometry
    precise: PreciseIsometry
    letters: tuple[Letters, ...]
    mate: Ints


@dataclass(frozen=True, eq=False)
class DirichletDomain(Generators):
    """The points x of X with d(x, 0) <= d(x, g 0) for all g in a group, by the elements g whose bisectors bound it.

    Whoever crosses the side of g comes nearer to g 0. So every tile but the first has a neighbour whose centre is
    nearer to the origin. No element but the identity may fix the origin. The first `side_count` elements have sides,
    counterclockwise; those after it are inverses that rounding left out. In S^2 all elements are there.
    """

    side_count: int

    @cached_property
    def bisectors(self) -> Floats:
        """Covectors (m, 3): bisectors @ x is the versine of x from the origin less that of x from g 0."""
        return _bisectors(self.geometry, self.precise)

    @cached_property
    def vertices(self) -> Floats:
        """The corners (side_count, 3) in H^2 and E^2; side k runs from corner k to corner k + 1."""
        sides = self.bisectors[: self.side_count]
        return self.geometry.project(np.cross(np.roll(sides, 1, axis=0), sides))

    @cached_property
    def circumradius(self) -> float:
        """Every point of X is as near as this to some image of the origin."""
        if self.geometry.curvature > 0:
            return float(np.pi if len(self.mate) == 0 else np.pi / 2)
        return float(self.geometry.distance(self.geometry.origin, self.vertices).max())


def dirichlet_domain_of(group: Group) -> DirichletDomain:
    """The Dirichlet domain of a group about the origin.

    It starts from `group.pairings()`, those of the sides of the domain of the group. As long as the polygon of their
    bisectors has a larger area than X/H, some product of two elements cuts off a part of it. In S^2 all elements are
    listed instead.
    Raises GeometryError for a group whose pairings are no letters, or whose elements fix the origin.
    """
    geometry = group.geometry
    if geometry.curvature > 0:
        letters: list[Letters] = [(label,) for label in sorted({abs(letter) for letter in group.word.letters})]
        precise = PreciseIsometry.joined(
            [PreciseIsometry.of_matrix(1, group.generator(label)[None]) for (label,) in letters]
        )
        while len((grown := _distinct(*_with_products(precise, letters)))[1]) > len(letters):
            precise, letters = grown
        return _paired(geometry, *_distinct(precise, letters))
    precise, letters = lettered_pairings(group)
    kept, words = precise, letters
    for _ in range(_MOST_ROUNDS):
        sides = _hull(geometry, kept)
        if sides is not None and abs(_polygon_area(geometry, kept[sides]) / group.area - 1) < _SAME_AREA:
            return _paired(geometry, kept[sides], [words[k] for k in sides])
        if sides is not None:
            kept, words = PreciseIsometry.joined([kept[sides], precise]), [*(words[k] for k in sides), *letters]
        kept, words = _distinct(*_with_products(kept, words))
    raise GeometryError(
        f"no Dirichlet domain of '{group.word}' after {_MOST_ROUNDS} rounds; its area does not come down to "
        f"{group.area:.9g}, that of X/H: check the side pairings, or start from a less slender polygon"
    )


def lettered_pairings(group: Group) -> tuple[PreciseIsometry, list[Letters]]:
    """The side pairings and the letter of each. Raises GeometryError for one that is no generator."""
    atlas, names = group.atlas(), {abs(letter) for letter in group.word.letters}
    pairings = group.pairings()
    matrices, letters = pairings.matrix, list[Letters]()
    generators = {letter: group.generator(letter) for letter in sorted(names)}
    generators.update({-letter: group.geometry.inverse(g) for letter, g in generators.items()})
    for k, matrix in enumerate(matrices):
        fits = [letter for letter, g in generators.items() if _agree(g, matrix)]
        if not fits or atlas.patch_count != 1:
            raise GeometryError(
                f"pairing {k} of the group of '{group.word}' is no generator; give a group of one domain"
            )
        letters.append((max(fits),))
    return pairings, letters


def _with_products(precise: PreciseIsometry, letters: list[Letters]) -> tuple[PreciseIsometry, list[Letters]]:
    """Elements, their inverses and all products of two elements, shorter words first."""
    count = np.arange(len(letters))
    pair = count.repeat(len(count)), np.tile(count, len(count))
    words = [
        *letters,
        *(inverse_letters(w) for w in letters),
        *(reduced_letters(letters[i] + letters[j]) for i, j in zip(*pair, strict=True)),
    ]
    return PreciseIsometry.joined([precise, precise.inverse, precise[pair[0]] @ precise[pair[1]]]), words


def _distinct(precise: PreciseIsometry, letters: list[Letters]) -> tuple[PreciseIsometry, list[Letters]]:
    """Each element once, with the first of its words; without the identity."""
    flat = np.concatenate([np.eye(3)[None], precise.matrix]).reshape(-1, 9)
    flat /= np.abs(flat).max(axis=1, keepdims=True)
    pairs = cKDTree(flat).query_pairs(_SAME, p=np.inf, output_type="ndarray")
    chosen = np.setdiff1d(np.arange(1, len(flat)), pairs.max(axis=1)) - 1
    return precise[chosen], [letters[k] for k in chosen]


def _agree(g: Floats, h: Floats) -> bool:
    return bool(np.abs(g - h).max() <= _SAME * max(1.0, np.abs(g).max()))


def _bisectors(geometry: Geometry, precise: PreciseIsometry) -> Floats:
    place = precise.place
    return np.concatenate([-geometry.versine(geometry.origin, place)[:, None], place[:, 1:]], axis=1)


def _hull(geometry: Geometry, precise: PreciseIsometry) -> Ints | None:
    """The elements whose bisectors bound the domain, counterclockwise; None where they bound no compact polygon.

    A bisector (-c, q) is the line q . x = c, dual to the point q / c; the polygon is dual to the hull of these points.
    """
    covectors = _bisectors(geometry, precise)
    if not (covectors[:, 0] < 0).all():
        raise GeometryError("an element of the group fixes the origin; move the polygon so that the origin is free")
    dual = covectors[:, 1:] / -covectors[:, :1]
    try:
        found = np.asarray(ConvexHull(dual).vertices, dtype=np.intp)
    except QhullError:
        return None
    after = dual[np.roll(found, -1)]
    turns = dual[found][:, 0] * after[:, 1] - dual[found][:, 1] * after[:, 0]
    corners = np.cross(covectors[found], covectors[np.roll(found, -1)])
    inside = corners[:, 0] ** 2 + geometry.curvature * (corners[:, 1] ** 2 + corners[:, 2] ** 2) > 0
    return found if (turns > 0).all() and inside.all() and (corners[:, 0] > 0).all() else None


def _polygon_area(geometry: Geometry, precise: PreciseIsometry) -> float:
    sides = _bisectors(geometry, precise)
    corners = geometry.project(np.cross(sides, np.roll(sides, -1, axis=0)))
    return float(geometry.triangle_area(geometry.origin, corners, np.roll(corners, -1, axis=0)).sum())


def _paired(geometry: Geometry, precise: PreciseIsometry, letters: list[Letters]) -> DirichletDomain:
    """The domain whose sides belong to some elements, with the inverses of them all."""
    if not letters:
        return DirichletDomain(geometry, precise, (), np.zeros(0, dtype=np.intp), 0)
    every, words = _distinct(
        PreciseIsometry.joined([precise, precise.inverse]), [*letters, *map(inverse_letters, letters)]
    )
    matrices = every.matrix
    inverse = geometry.inverse(matrices)
    mate = np.array([next(j for j, h in enumerate(matrices) if _agree(h, g)) for g in inverse])
    return DirichletDomain(geometry, every, tuple(words), mate, len(letters))
