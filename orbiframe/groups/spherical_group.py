"""SphericalGroup: a finite group of isometries of the sphere, with or without fixed points, listed in full."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from orbiframe.errors import GeometryError
from orbiframe.groups.group import Group
from orbiframe.orbifolds.atlas import Atlas
from orbiframe.planes.geometry import Geometry
from orbiframe.words.conway_symbol import ConwaySymbol
from orbiframe.words.mirror_word import MirrorWord, Relations, word_of

Floats = NDArray[np.float64]

_SAME = 1e-6
_ON_SIDE = 1e-12
_STEP = 1e-4  # sides are longer than this
_PLACES = 2000  # points among which the origin is chosen


class SphericalGroup(Group):
    """The group of one of the seven families or seven exceptions of Conway's list of spherical orbifolds.

    The domain holds the points x for which no image g x is nearer to the origin than x. The origin is a point that its
    images stay well away from, so only the identity fixes it. For a group of reflections that is a chamber.

    Raises GeometryError for an orbifold that is not spherical, or another geometry.
    """

    word: MirrorWord

    def __init__(self, geometry: Geometry, signature: ConwaySymbol) -> None:
        if geometry.curvature != 1 or signature.curvature != 1:
            raise GeometryError(
                f"'{signature}' has the Euler characteristic {signature.euler_characteristic}, wanted in "
                f"{geometry.name}; a spherical group has a positive one and lives in s2"
            )
        self.geometry, self.signature = geometry, signature
        self.word, self.orders = word_of(signature)
        generators = _generators(geometry, signature)
        place = geometry.carry(_generic_point(geometry, _closure(generators)))
        self._generators = geometry.inverse(place) @ generators @ place
        self.elements = _closure(self._generators)
        self.area = 4 * np.pi / len(self.elements)

    @property
    def relations(self) -> Relations:
        """The presentation by the letters of the word."""
        return Relations.of(self.word, self.orders)

    def atlas(self) -> Atlas:
        """One patch; its transitions are all elements of the group."""
        elements = self.elements
        patch = np.arange(len(elements)) > 0
        inverse = np.asarray(cKDTree(elements.reshape(-1, 9)).query(self.geometry.inverse(elements).reshape(-1, 9))[1])
        tail = np.where(patch, 0, -1)
        return Atlas(self.geometry, np.array([self.circumradius]), tail, tail.copy(), inverse, elements)

    def generator(self, label: int) -> Floats:
        """The rotation, reflection or rotary reflection that a letter stands for."""
        return np.asarray(self._generators[label - 1])

    def tiles(self, radius: float) -> Floats:
        """Every g whose tile meets the disc, by the distance of the origin from the domain moved by g."""
        centres = self.geometry.inverse(self.elements)[..., 0]
        gap = np.array([self._distance_from_domain(centre) for centre in centres])
        near = np.flatnonzero(gap <= radius + 1e-9)
        order = np.argsort(self.geometry.distance(self.geometry.origin, self.elements[near, :, 0]), kind="stable")
        return self.elements[near[order]]

    def reduce(self, x: ArrayLike) -> tuple[Floats, Floats]:
        """The image that is nearest to the origin; of several the first in the list of elements."""
        points = self.geometry.settle(x)
        height = np.einsum("gj,...j->...g", self.elements[:, 0, :], points)
        g = self.elements[np.argmax(height >= height.max(axis=-1, keepdims=True) - _ON_SIDE, axis=-1)]
        return self.geometry.act(g, points), g

    @cached_property
    def sides(self) -> Floats:
        """Covectors (m, 3), positive in the domain, of the great circles that bound it.

        A half of the sphere has one, a lune two.
        """
        planes = self.geometry.origin - self.elements[1:, :, 0]
        planes = np.asarray(planes / np.linalg.norm(planes, axis=-1, keepdims=True))
        if len(planes) < 2:
            return planes
        ends = self._corners_of(planes)
        return np.asarray(planes[[self._leaves_some(ends, plane, planes) for plane in planes]])

    @cached_property
    def vertices(self) -> Floats:
        """The corners of the domain, (k, 3): none of a half of the sphere, two of a lune."""
        return self._corners_of(self.sides)

    @cached_property
    def circumradius(self) -> float:
        """Every point of the domain lies within this of the origin."""
        if len(self.sides) == 0:
            return float(np.pi)
        if len(self.sides) == 1:
            return float(np.pi / 2 + self.geometry.distance(self.geometry.origin, self.sides[0]))
        return float(self.geometry.distance(self.geometry.origin, self.vertices).max())

    def _leaves_some(self, corners: Floats, plane: Floats, planes: Floats) -> bool:
        """Whether a great circle goes on along the domain from some corner, and does not only touch it there."""
        on = corners[np.abs(corners @ plane) < _SAME]
        steps = _STEP * np.cross(plane, on)
        ahead = np.concatenate([on + steps, on - steps])
        return bool((ahead @ planes.T >= -_STEP * _STEP).all(axis=-1).any())

    def _corners_of(self, planes: Floats) -> Floats:
        """The points where two of the great circles meet and no other cuts them off, each once."""
        first, second = np.triu_indices(len(planes), 1)
        ends = np.cross(planes[first], planes[second])
        size = np.linalg.norm(ends, axis=-1)
        ends = ends[size > _SAME] / size[size > _SAME, None]
        ends = np.concatenate([ends, -ends])
        ends = ends[(ends @ planes.T >= -_SAME / 10).all(axis=-1)]
        repeated = cKDTree(ends).query_pairs(_SAME, output_type="ndarray")
        return ends[np.setdiff1d(np.arange(len(ends)), repeated.max(axis=1))] if len(ends) else ends

    def _distance_from_domain(self, point: Floats) -> float:
        """How far a point is from the domain: its own place, its feet on the sides and the corners are tried."""
        feet = point - (self.sides @ point)[:, None] * self.sides
        feet = feet[np.linalg.norm(feet, axis=-1) > _SAME]
        places = np.concatenate([point[None], self.geometry.project(feet), self.vertices])
        inside = (places @ self.sides.T >= -_SAME).all(axis=-1)
        if not inside.any():
            # The domain is half of the sphere and the point its antipole: all of the rim is nearest.
            return float(np.pi / 2)
        return float(self.geometry.distance(point, places[inside]).min())


def _generators(geometry: Geometry, signature: ConwaySymbol) -> Floats:
    """An isometry for every letter of `word_of(signature)`, (k, 3, 3), that its relations hold for."""
    cones, corners = signature.cones, signature.mirrors[0] if signature.mirrors else ()
    if signature.crosscaps:
        return _with_crosscap(geometry, cones)
    if signature.mirrors and cones:
        return _with_one_mirror(geometry, cones[0], corners)
    if signature.mirrors:
        return _reflections(corners)
    if len(cones) == 3:
        p, q, r = _reflections((cones[2], cones[0], cones[1]))
        return np.stack([p @ q, q @ r, r @ p])
    turn = geometry.rotation(2 * np.pi / cones[0]) if cones else np.eye(3)
    return np.stack([turn, turn.T])[: max(1, len(cones))]


def _reflections(corners: tuple[int, ...]) -> Floats:
    """Reflections in the sides of a disc with these corners; corner k lies between side k - 1 and side k."""
    size = max(1, len(corners))
    gram = np.eye(size)
    for k, m in enumerate(corners):
        gram[k, k - 1] = gram[k - 1, k] = -np.cos(np.pi / m)
    normals = np.zeros((size, 3))
    normals[:, :size] = np.linalg.cholesky(gram)
    return np.stack([_reflection(normal) for normal in normals])


def _with_one_mirror(geometry: Geometry, cone: int, corners: tuple[int, ...]) -> Floats:
    """A rotation a, its inverse, a mirror c, and its image under a where the two meet in a corner.

    The mirror's normal has the angle t with the axis, so that sin^2 t (1 - cos 2 pi / n) = 1 + cos pi / m; without a
    corner it is the axis.
    """
    turn = geometry.rotation(2 * np.pi / cone)
    rise = (1 + np.cos(np.pi / corners[0])) / (1 - np.cos(2 * np.pi / cone)) if corners else 0.0
    mirror = _reflection(np.array([np.sqrt(1 - rise), np.sqrt(rise), 0.0]))
    return np.stack([turn, turn.T, mirror, turn @ mirror @ turn.T][: 3 + len(corners)])


def _with_crosscap(geometry: Geometry, cones: tuple[int, ...]) -> Floats:
    """A rotation a and a rotary reflection b with a b b = 1; the antipodal map alone without a cone point."""
    if not cones:
        return -np.eye(3)[None]
    half = geometry.rotation(np.pi / cones[0])
    return np.stack([half @ half, half.T * np.array([-1.0, 1.0, 1.0])])


def _reflection(normal: Floats) -> Floats:
    return np.asarray(np.eye(3) - 2 * np.outer(normal, normal))


def _closure(generators: Floats) -> Floats:
    """All products of the generators, (order, 3, 3), the identity first."""
    found = frontier = np.eye(3)[None]
    while len(frontier):
        products = (frontier[:, None] @ generators).reshape(-1, 3, 3)
        flat = np.concatenate([found, products]).reshape(-1, 9)
        repeated = cKDTree(flat).query_pairs(_SAME, output_type="ndarray")
        new = np.setdiff1d(np.arange(len(found), len(flat)), repeated.max(axis=1)) - len(found)
        frontier = _orthogonal(products[new])
        found = np.concatenate([found, frontier])
    return found


def _orthogonal(g: Floats) -> Floats:
    """The orthogonal matrices next to some that are so up to rounding."""
    return np.asarray(1.5 * g - 0.5 * g @ np.swapaxes(g, -1, -2) @ g)


def _generic_point(geometry: Geometry, elements: Floats) -> Floats:
    """The point, of many spread evenly over the sphere, whose images are farthest from it."""
    k = np.arange(_PLACES) + 0.5
    height, turn = 1 - 2 * k / _PLACES, np.pi * (3 - np.sqrt(5)) * k
    x = geometry.project(np.stack([height, *(np.sqrt(1 - height**2) * f(turn) for f in (np.cos, np.sin))], axis=-1))
    if len(elements) == 1:
        return geometry.origin
    likeness = np.full(len(x), -1.0)
    for g in elements[1:]:
        likeness = np.maximum(likeness, np.einsum("ni,ij,nj->n", x, g, x))
    return np.asarray(x[likeness.argmin()])
