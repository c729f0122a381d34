"""Elements: the elements of a group by the distance that they move the origin, each once, with its word."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.errors import GeometryError
from orbiframe.groups.dirichlet_domain import DirichletDomain, Generators, dirichlet_domain_of
from orbiframe.groups.element_tree import DONE, MANY, ON_RIM, TIED, grow
from orbiframe.groups.group import Group
from orbiframe.planes.precise_isometry import PreciseIsometry
from orbiframe.words.word import reduced_letters

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# The disc is larger by this share, so that an element on its rim counts as inside.
_RIM = 1e-9
_MOST = 100_000_000
_REASON = {
    TIED: "rounding decides which side of the domain is nearest to the origin; ask for fewer elements",
    ON_RIM: "rounding decides whether an element moves the origin by the radius or by more; change the radius a little",
    MANY: "there are more than {} elements; ask for fewer, or raise most",
}


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements of a group; the first is the identity, and each other one is its parent times a generator.

    generators: those across the sides of a domain; a, b: (n,) complex and reverses: (n,), the isometries as
    `PreciseIsometry` has them; parent: (n,), a smaller number, -1 for the identity; step: (n,), the generator on the
    right.

    A product of k steps has the relative error k eps in a and b, which is k eps e^d as a distance, for an element
    that moves the origin by d.
    """

    generators: Generators
    a: NDArray[np.complex128]
    b: NDArray[np.complex128]
    reverses: NDArray[np.bool_]
    parent: NDArray[np.int32]
    step: NDArray[np.int16]

    def __len__(self) -> int:
        return len(self.a)

    def precise(self, chosen: ArrayLike = slice(None)) -> PreciseIsometry:  # type: ignore[assignment]
        """Some of the elements, or all, as pairs of complex numbers."""
        a, b = (part[chosen].astype(np.clongdouble) for part in (self.a, self.b))  # type: ignore[index]
        return PreciseIsometry(self.generators.geometry.curvature, a, b, self.reverses[chosen])  # type: ignore[index]

    @property
    def distance(self) -> Floats:
        """How far each element moves the origin, (n,)."""
        half = np.abs(self.b)
        if self.generators.geometry.curvature > 0:
            return 2 * np.arctan2(half, np.abs(self.a))
        return 2 * (np.arcsinh(half) if self.generators.geometry.curvature else half)

    @property
    def depth(self) -> Ints:
        """How many steps each element is from the identity, (n,)."""
        depth = np.zeros(len(self), dtype=np.intp)
        ends = np.searchsorted(self.parent, np.arange(-1, len(self)))
        level, start, stop = 0, 0, 1
        while start < stop:
            depth[start:stop] = level
            level, start, stop = level + 1, stop, int(ends[stop + 1]) if stop < len(self) else len(self)
        return depth

    def word(self, number: int) -> tuple[int, ...]:
        """The letters of an element, read off on the way from it to the identity; freely reduced."""
        steps = list[int]()
        while self.parent[number] >= 0:
            steps.append(int(self.step[number]))
            number = int(self.parent[number])
        return reduced_letters(letter for step in reversed(steps) for letter in self.generators.letters[step])


def elements_within(group: Group, radius: float, *, most: int = _MOST) -> Elements:
    """Every element of a group that moves the origin by at most `radius`, each once.

    The tiles of the Dirichlet domain about the origin form a tree: the parent of a tile is the one whose centre is
    nearer to the origin by most, of several the one across the first side. A tile is entered from its parent only, so
    that nothing is looked up and nothing comes twice. Raises GeometryError where rounding decides whether an element
    is on the rim of the disc or which side is the first, and where there are more than `most` elements.
    """
    return elements_of_domain(dirichlet_domain_of(group), group.area, radius, most=most)


def elements_of_domain(domain: DirichletDomain, area: float, radius: float, *, most: int = _MOST) -> Elements:
    """The same from the Dirichlet domain of the group and the area of X/H."""
    k = domain.geometry.curvature
    half = np.sin(min(radius, np.pi) / 2) if k > 0 else np.sinh(radius / 2) if k else radius / 2
    expected = 4 * np.pi * half**2 / area
    if not 0 <= radius < np.inf or expected > most:
        raise GeometryError(
            f"a disc of radius {radius:.6g} holds about {expected:.3g} images of the origin; give a radius from 0 on "
            f"for which there are no more than {most}, or raise most"
        )
    reach = half**2 * (1 + _RIM) + _RIM * _RIM
    return grown_elements(domain, domain.bisectors, domain.side_count, reach, -1, 1000 + int(1.05 * expected), 2 * most)


def grown_elements(
    steps: Generators, covectors: Floats, bounding: int, reach: float, depth: int, room: int, most: int
) -> Elements:
    """What `element_tree.grow` finds. Raises GeometryError where it stops early."""
    a, b = (part.astype(np.complex128) for part in (steps.precise.a, steps.precise.b))
    generators = (a, b, steps.precise.reverses), steps.mate, covectors, bounding
    found, count, end = grow(steps.geometry.curvature, *generators, reach, _RIM / 100, depth, room, most)
    if end != DONE:
        raise GeometryError(_REASON[end].format(most))
    return Elements(steps, *(part[:count] for part in found))
