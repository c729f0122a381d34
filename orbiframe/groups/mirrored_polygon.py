"""MirroredPolygon: a convex polygon with glued sides and mirrors, and Poincare's conditions with singular points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from orbiframe.components.geometry_names import geometry_name
from orbiframe.errors import GeometryError
from orbiframe.groups.fundamental_polygon import FundamentalPolygon
from orbiframe.planes.geometry import Geometry
from orbiframe.words.conway_symbol import ConwaySymbol
from orbiframe.words.mirror_word import MirrorWord, word_of

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_SOLVED = 1e-10


@dataclass(frozen=True, eq=False)
class MirroredPolygon(FundamentalPolygon):
    """A convex polygon with the origin inside, whose sides are glued in pairs or are mirrors.

    A vertex has the order n if the angles round it add up to 2 pi / n, or between two mirrors to pi / n: a cone point,
    a corner, and for n = 1 a point like others. Then the side pairings generate a discrete group with this polygon as
    its polygon (Poincare's theorem). word: a `MirrorWord`; half a turn about the middle of a side is that side cut in
    two there, at a vertex with the angle pi, and glued as aA.
    """

    word: MirrorWord

    @cached_property
    def angle_sums(self) -> Floats:
        """The sum of the angles round every vertex, in the order of `word.cycles`."""
        return np.array([self.interior_angles[list(cycle.corners)].sum() for cycle in self.word.cycles])

    @cached_property
    def orders(self) -> tuple[int, ...]:
        """The whole number nearest to what makes the angle sum of every vertex 2 pi / n, at mirrors pi / n."""
        return tuple(np.maximum(1, np.rint(self._whole_angles / self.angle_sums)).astype(int).tolist())

    @cached_property
    def angle_defects(self) -> Floats:
        """The angle sum of every vertex minus that of its order: zero for a fundamental polygon."""
        return np.asarray(self.angle_sums - self._whole_angles / np.array(self.orders))

    @property
    def signature(self) -> ConwaySymbol:
        """The orbifold that one gets by folding, read off the angles and the gluing."""
        return self.word.signature(self.orders)

    @cached_property
    def relation_defect(self) -> float:
        """Largest entry of w^n - 1 over the relations; grows like eps e^(2 circumradius)."""
        powers = (
            np.linalg.matrix_power(self._product(relation), order)
            for relation, order in zip(self.word.relations, self.orders, strict=True)
        )
        return max(float(np.abs(power - np.eye(3)).max()) for power in powers)

    def require_conditions(self, tolerance: float = 1e-8) -> None:
        """Raise GeometryError, naming the side or vertex, unless Poincare's conditions hold to the tolerance."""
        self.require_equal_lengths(tolerance)
        cycle = int(np.abs(self.angle_defects).argmax())
        if abs(self.angle_defects[cycle]) > tolerance * len(self.word):
            corners = ", ".join(map(str, self.word.vertex_cycles[cycle]))
            whole, what = ("pi", "corner of mirrors") if self.word.cycles[cycle].ends else ("2 pi", "cone point")
            share = self._whole_angles[cycle] / self.angle_sums[cycle]
            raise GeometryError(
                f"the angles at the corners {corners} of '{self.word}' add up to {self.angle_sums[cycle]:.9g}, which "
                f"is {whole} / {share:.9g}; a {what} needs {whole} / n with a whole number n"
            )

    @cached_property
    def _whole_angles(self) -> Floats:
        return np.array([np.pi if cycle.ends else 2 * np.pi for cycle in self.word.cycles])


def orbifold_polygon(geometry: Geometry, signature: ConwaySymbol) -> MirroredPolygon:
    """A convex polygon for an orbifold with Euler characteristic 0 or less.

    The polygon is a fan of triangles about the origin. Each of its vertices is the centre of a circle, circles of
    neighbours touch, and the angles at a vertex add up to 2 pi divided by its order: radii like these exist, and only
    one set (in E^2 up to scale), by the theorem of Koebe, Andreev and Thurston. Triangle groups give their triangle. In
    E^2 the polygon has the area 1, and its last side is the lowest.

    Raises GeometryError for another geometry, or where the radii cannot be found to ten digits.
    """
    if signature.curvature > 0 or signature.curvature != geometry.curvature:
        right = geometry_name(signature.curvature)
        raise GeometryError(
            f"'{signature}' has the Euler characteristic {signature.euler_characteristic}, so it lives in {right}; a "
            f"polygon is wanted in {geometry.name}, where it is to be 0 (e2) or negative (h2)"
        )
    word, orders = word_of(signature)
    corner_class, targets = _classes(word, orders)
    radius = _radii(geometry.curvature, corner_class, targets)
    after = np.roll(corner_class, -1)
    central = _angle(geometry.curvature, radius[0], radius[1 + corner_class], radius[1 + after])
    reach = radius[0] + radius[1 + corner_class]
    direction = np.concatenate([[0.0], np.cumsum(central)[:-1]])
    if geometry.curvature == 0:
        reach, direction = _unit_area(reach, direction, central)
    return MirroredPolygon(geometry, geometry.from_polar(reach, direction), word)


def _unit_area(reach: Floats, direction: Floats, central: Floats) -> tuple[Floats, Floats]:
    """Polar coordinates of the corners scaled to the area 1, and turned so that the last side runs to the right."""
    area = (reach * np.roll(reach, -1) * np.sin(central)).sum() / 2
    corner = reach * np.exp(1j * direction)
    return reach / np.sqrt(area), direction - np.angle(corner[0] - corner[-1])


def _classes(word: MirrorWord, orders: tuple[int, ...]) -> tuple[Ints, Floats]:
    """A number for the vertex at every corner, (n,), and the angle that each vertex needs."""
    corner_class = np.empty(len(word), dtype=np.intp)
    for number, cycle in enumerate(word.cycles):
        corner_class[list(cycle.corners)] = number
    whole = [np.pi if cycle.ends else 2 * np.pi for cycle in word.cycles]
    return corner_class, np.array(whole) / np.array(orders)


def _radii(curvature: int, corner_class: Ints, targets: Floats) -> Floats:
    """The radii of the circles about the origin and about every vertex."""
    after = np.roll(corner_class, -1)

    def defects(logarithm: Floats) -> Floats:
        radius = np.exp(logarithm)
        here, there = radius[1 + corner_class], radius[1 + after]
        sums = np.bincount(corner_class, _angle(curvature, here, there, radius[0]), len(targets))
        sums += np.bincount(after, _angle(curvature, there, here, radius[0]), len(targets))
        centre = _angle(curvature, radius[0], here, there).sum() - 2 * np.pi
        scale = [] if curvature else [logarithm.sum()]
        return np.concatenate([[centre], sums - targets, scale])

    start = np.full(1 + len(targets), 0.0 if curvature == 0 else -0.5)
    found = least_squares(defects, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=1000)
    solution, slope = np.asarray(found.x, dtype=np.float64), np.linalg.pinv(np.asarray(found.jac, dtype=np.float64))
    for _ in range(3):
        # Newton's steps with the last derivative bring the last digits.
        solution = solution - slope @ defects(solution)
    worst = float(np.abs(defects(solution)).max())
    if not worst < _SOLVED:
        raise GeometryError(
            f"the radii of a polygon with {len(corner_class)} corners miss their angles by {worst:.3g}; the orders are "
            "too large for the precision"
        )
    return np.asarray(np.exp(solution))


def _angle(curvature: int, r: Floats, s: Floats, t: Floats) -> Floats:
    """The angle at the centre of the first of three circles that touch one another."""
    if curvature:
        return np.asarray(2 * np.arctan(np.sqrt(np.sinh(s) * np.sinh(t) / (np.sinh(r) * np.sinh(r + s + t)))))
    return np.asarray(2 * np.arctan(np.sqrt(s * t / (r * (r + s + t)))))
