"""FundamentalPolygon: a convex polygon with its sides glued in pairs, and Poincare's conditions (sections 2.2, 2.3)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.components.geometry_names import geometry_name
from orbiframe.components.one_line import one_line
from orbiframe.errors import GeometryError
from orbiframe.planes.geometry import Geometry
from orbiframe.planes.precise_isometry import PreciseIsometry
from orbiframe.words.word import Word

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

# The distance of a point from a line, by curvature, from its sine as `FundamentalPolygon.sides` gives it.
_ARCSINE: dict[int, Callable[[float], float]] = {1: math.asin, 0: float, -1: math.asinh}


@dataclass(frozen=True, eq=False)
class FundamentalPolygon:
    """A convex polygon with the origin inside, whose sides a word glues in pairs.

    geometry; vertices: (n, 3), counterclockwise; word: n letters, letter p is the side from vertex p to vertex p + 1.
    The side pairing h_s maps the mate s' to s, so that F and h_s F meet in s. Raises GeometryError for another number
    of vertices, or a polygon that is not convex round the origin.

    >>> import numpy as np
    >>> from orbiframe import Registry, Word
    >>> from orbiframe.groups import regular_polygon
    >>> octagon = regular_polygon(Registry.discover().load("geometry", "h2")(), Word.parse("abABcdCD"))
    >>> print(np.degrees(octagon.interior_angles[0]).round(9), round(octagon.area / np.pi, 9))
    45.0 4.0
    """

    geometry: Geometry
    vertices: Floats
    word: Word

    __repr__ = one_line

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", _coordinates(self.vertices))
        if self.vertices.shape != (len(self.word), 3):
            raise GeometryError(
                f"{len(self.vertices)} vertices for the {len(self.word)} letters of '{self.word}'; side p runs from "
                "vertex p to the next, so the two numbers must agree"
            )
        inside, turns = self.sides @ self.geometry.origin, self.interior_angles
        convex = (inside > 0) & (turns > 0) & (turns < np.pi * (1 + 1e-12)) & (self.vertices[:, 0] > 1e-12)
        bad = np.flatnonzero(~convex)
        if bad.size:
            raise GeometryError(
                f"side {bad[0]} has the origin at the signed distance {inside[bad[0]]:.3g} (its sine) and the angle "
                f"{turns[bad[0]]:.6g} at its start; give the vertices of a convex polygon counterclockwise round the "
                "origin, in S^2 within an open hemisphere"
            )

    @cached_property
    def heads(self) -> Floats:
        """The end of every side, (n, 3)."""
        return np.roll(self.vertices, -1, axis=0)

    @cached_property
    def side_lengths(self) -> Floats:
        """Length of every side, (n,)."""
        return self.geometry.distance(self.vertices, self.heads)

    @cached_property
    def interior_angles(self) -> Floats:
        """Interior angle at every vertex in (0, 2 pi), (n,)."""
        after, before = self.directions
        return np.asarray(np.mod(before - after, 2 * np.pi), dtype=np.float64)

    @cached_property
    def directions(self) -> tuple[NDArray[np.longdouble], NDArray[np.longdouble]]:
        """At every vertex the directions of the next and of the previous one in `geometry.frame`, (n,) each.

        Found with the vertex moved to the origin, so that they keep their digits where the polygon is large.
        """
        corner = PreciseIsometry.translation(self.geometry.curvature, self.vertices)
        turned = np.arange(len(self.vertices))
        after, before = ((corner.inverse @ corner[np.roll(turned, shift)]).direction for shift in (-1, 1))
        return after, before

    @cached_property
    def sides(self) -> Floats:
        """The line of every side as a covector, (n, 3): sides @ x is the sine (H^2: sinh) of the distance of x from it.

        It is positive inside. In E^2 it is the distance itself.
        """
        normals = np.cross(self.vertices, self.geometry.chord(self.vertices, self.heads))
        return np.asarray(normals / self.geometry.from_polar(self.side_lengths, 0.0)[:, 1:2])

    @cached_property
    def side_flags(self) -> Floats:
        """The isometries that take the origin and the direction (0, 1, 0) to the middle of a side and its run."""
        middles = self.geometry.project(self.vertices + self.heads)
        return self.geometry.flag(middles, self.geometry.log(middles, self.heads))

    @cached_property
    def pairings(self) -> Floats:
        """The side pairings h_s, (n, 3, 3)."""
        geometry, mates = self.geometry, list(self.word.mate)
        parallel = np.array([self.word.reverses(side) for side in range(len(self.word))])
        swap = np.where(parallel[:, None, None], geometry.reflection(0.0), geometry.rotation(np.pi))
        return np.asarray(self.side_flags @ swap @ geometry.inverse(self.side_flags[mates]))

    @cached_property
    def circumradius(self) -> float:
        """The largest distance of a vertex from the origin."""
        return float(self.geometry.distance(self.geometry.origin, self.vertices).max())

    @cached_property
    def inradius(self) -> float:
        """The distance of the origin from the nearest side."""
        return _ARCSINE[self.geometry.curvature](float((self.sides @ self.geometry.origin).min()))

    @cached_property
    def area(self) -> float:
        """Area, summed over the triangles from the origin."""
        return float(self.geometry.triangle_area(self.geometry.origin, self.vertices, self.heads).sum())

    # ---- Poincare's conditions ----------------------------------------------------------------------------------

    @cached_property
    def length_defects(self) -> Floats:
        """Length of every side minus length of its mate, (n,): zero for a fundamental polygon."""
        return np.asarray(self.side_lengths - self.side_lengths[list(self.word.mate)])

    @cached_property
    def angle_defects(self) -> Floats:
        """Sum of the angles round every vertex cycle of the word minus 2 pi: zero for a surface without cone points."""
        angles = self.interior_angles
        return np.array([angles[list(cycle)].sum() for cycle in self.word.vertex_cycles]) - 2 * np.pi

    @cached_property
    def relation_defect(self) -> float:
        """Largest entry of h_s1 ... h_sk - 1 over the relations of the word; grows like eps e^(2 circumradius)."""
        return max(float(np.abs(self._product(relation) - np.eye(3)).max()) for relation in self.word.relations)

    def require_conditions(self, tolerance: float = 1e-8) -> None:
        """Raise GeometryError, naming the side or vertex, unless Poincare's conditions hold to the tolerance."""
        self.require_equal_lengths(tolerance)
        cycle = int(np.abs(self.angle_defects).argmax())
        if abs(self.angle_defects[cycle]) > tolerance * len(self.word):
            corners = ", ".join(map(str, self.word.vertex_cycles[cycle]))
            raise GeometryError(
                f"the angles at the corners {corners} of '{self.word}' add up to "
                f"{self.angle_defects[cycle] + 2 * np.pi:.9g}; corners that are glued to one point need 2 pi"
            )

    def require_equal_lengths(self, tolerance: float = 1e-8) -> None:
        """Raise GeometryError, naming the sides, where two glued sides have different lengths."""
        side = int(np.abs(self.length_defects).argmax())
        if abs(self.length_defects[side]) > tolerance * max(1.0, float(self.side_lengths.max())):
            mate = self.word.mate[side]
            raise GeometryError(
                f"sides {side} and {mate} of '{self.word}' are glued but have the lengths "
                f"{self.side_lengths[side]:.9g} and {self.side_lengths[mate]:.9g}; they must be equal"
            )

    def meets_disc(self, centre: ArrayLike, radius: float) -> Bools:
        """Whether the polygon meets the closed disc of the given radius about each of the points `centre` (..., 3)."""
        points = np.asarray(centre, dtype=float)
        inside = (points @ self.sides.T >= 0).all(axis=-1)
        sine = float(self.geometry.from_polar(radius, 0.0)[1])
        above = self._along(points, self.vertices, self.heads) & self._along(points, self.heads, self.vertices)
        near_side = (above & (np.abs(points @ self.sides.T) <= sine)).any(axis=-1)
        near_vertex = (self.geometry.distance(points[..., None, :], self.vertices) <= radius).any(axis=-1)
        return np.asarray(inside | near_side | near_vertex)

    def _along(self, points: Floats, start: Floats, end: Floats) -> Bools:
        """Which points lie on the side of `end` of the perpendicular through `start`, (..., n)."""
        geometry, there = self.geometry, points[..., None, :]
        return np.asarray(geometry.inner(start, geometry.log(start, end), geometry.log(start, there)) >= 0)

    def _product(self, relation: tuple[int, ...]) -> Floats:
        product = np.eye(3)
        for side in relation:
            product = product @ self.pairings[side]
        return product


def _coordinates(vertices: ArrayLike) -> Floats:
    """Vertices as an array; any list of numbers will do."""
    try:
        found = np.asarray(vertices, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise GeometryError(f"the vertices are no numbers: {error}; give an array (n, 3) of points of X") from error
    if found.ndim != 2 or not np.isfinite(found).all():
        raise GeometryError(f"the vertices have the shape {found.shape}; give finite points of X, as an array (n, 3)")
    return found


def regular_polygon(geometry: Geometry, word: Word) -> FundamentalPolygon:
    """The regular polygon whose n sides a word glues, with n/V corners round each of V vertices (section 2.5).

    Interior angle alpha = 2 pi V / n and cosh R = cot(pi / n) cot(alpha / 2) for the circumradius R; for a word with
    one vertex, cosh R = cot^2(pi / n). Vertex k lies at angle 2 pi k / n in H^2. In E^2 the sides have length 1 and
    side 0 is the lowest; side 0 of the unit square runs from (-1/2, -1/2) to (1/2, -1/2).

    Raises GeometryError if the surface has another geometry, or its vertices have different numbers of corners.
    """
    size, cycles = len(word), word.vertex_cycles
    if geometry.curvature > 0:
        raise GeometryError(
            f"'{word}' has no convex polygon on the sphere: the polygons are the whole sphere and the hemisphere; "
            "choose the group 'finite'"
        )
    if np.sign(word.euler_characteristic) != geometry.curvature:
        right = geometry_name(word.euler_characteristic)
        raise GeometryError(f"'{word}' is a {word.surface}; its geometry is {right}, not {geometry.name}")
    if len({len(cycle) for cycle in cycles}) > 1:
        counts = ", ".join(str(len(cycle)) for cycle in cycles)
        raise GeometryError(
            f"the vertices of '{word}' have {counts} corners; a regular polygon needs the same number at every "
            "vertex: choose a word with one vertex"
        )
    if geometry.curvature == 0:
        radius, turn = 0.5 / np.sin(np.pi / size), -np.pi / 2 - np.pi / size
    else:
        radius, turn = _regular_radius(size, len(cycles)), 0.0
    angles = turn + 2 * np.pi * np.arange(size) / size
    return FundamentalPolygon(geometry, geometry.from_polar(radius, angles), word)


def _regular_radius(size: int, vertex_count: int) -> float:
    return float(np.arccosh(1 / (np.tan(np.pi / size) * np.tan(np.pi * vertex_count / size))))
