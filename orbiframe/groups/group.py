"""Group: a discrete group H of isometries with a closed surface X/H (section 2)."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.errors import GeometryError
from orbiframe.orbifolds.atlas import Atlas
from orbiframe.planes.geometry import Geometry
from orbiframe.planes.precise_isometry import PreciseIsometry
from orbiframe.words.word import Word, parse_letters

Floats = NDArray[np.float64]


class Group(ABC):
    """A discrete group of isometries that acts freely, with a polygon F round the origin whose sides a word glues.

    geometry; word: its letters name the generators, letter a the pairing of the first side marked a; area: of X/H.

    >>> from orbiframe import Registry, Word
    >>> registry = Registry.discover()
    >>> h2 = registry.load("geometry", "h2")()
    >>> group = registry.load("group", "regular-polygon")(h2, Word.parse("abABcdCD"))
    >>> len(group.tiles(1.5)), len(group.tiles(2.5))  # that meet a disc: the octagon alone; with all that touch it
    (1, 49)
    >>> g = group.element("abABcdCD")  # letters that go once round the polygon
    >>> g.shape
    (3, 3)
    """

    geometry: Geometry
    word: Word
    area: float

    @abstractmethod
    def atlas(self) -> Atlas:
        """X/H as one patch, the polygon F, with the side pairings as transitions."""

    @abstractmethod
    def tiles(self, radius: float) -> Floats:
        """Every g whose tile gF meets the closed disc of this radius about the origin, each once, (k, 3, 3).

        The first is the identity; the others follow in the order of the distance of their centres.
        """

    @abstractmethod
    def reduce(self, x: ArrayLike) -> tuple[Floats, Floats]:
        """Points x (..., 3) moved into F: (y, g) with y = g x in F, (..., 3), and g in the group, (..., 3, 3)."""

    @abstractmethod
    def generator(self, label: int) -> Floats:
        """The isometry that a label of the word stands for, (3, 3)."""

    def pairings(self) -> PreciseIsometry:
        """The transitions of `atlas()` without the identity, as pairs of complex numbers, (n,)."""
        return PreciseIsometry.of_matrix(self.geometry.curvature, self.atlas().isometry[1:])

    def precise_generator(self, label: int) -> PreciseIsometry:
        """The isometry that a label of the word stands for, as a pair of complex numbers."""
        return PreciseIsometry.of_matrix(self.geometry.curvature, self.generator(label))

    def element(self, letters: str | tuple[int, ...]) -> Floats:
        """The isometry of a word in the generators, (3, 3), upper case for inverses; "" is the identity.

        Raises GeometryError for a letter that the group does not have.
        """
        return self.precise_element(letters).matrix

    def precise_element(self, letters: str | tuple[int, ...]) -> PreciseIsometry:
        """The same as a pair of complex numbers, which keeps the digits that a large matrix loses."""
        product = PreciseIsometry.of_matrix(self.geometry.curvature, np.eye(3))
        for letter in parse_letters(letters) if isinstance(letters, str) else letters:
            if letter not in self.word.letters and -letter not in self.word.letters:
                raise GeometryError(f"letter {letter} is no generator; the generators are the letters of '{self.word}'")
            g = self.precise_generator(abs(letter))
            product = product @ (g if letter > 0 else g.inverse)
        return product
