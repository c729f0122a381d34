"""Presentation: the fundamental group of a closed surface by generators and a relator, and its first homology."""

from __future__ import annotations

from dataclasses import dataclass
from math import gcd

from orbiframe.errors import TopologyError
from orbiframe.words.word import Word, text_of


@dataclass(frozen=True, slots=True)
class Presentation:
    """A group by generators, positive letters, and one word in them that is trivial, empty for a free group."""

    generators: tuple[int, ...]
    relator: tuple[int, ...] = ()

    @classmethod
    def of(cls, word: Word) -> Presentation:
        """The fundamental group of the surface that a word glues: its letters, and the word itself.

        The word has one vertex, or is that of a sphere, `aA`. Raises TopologyError for another word, whose letters are
        paths from vertex to vertex and no loops.
        """
        if word.euler_characteristic == 2 and len(word) == 2:
            return cls(())
        if len(word.vertex_cycles) != 1:
            raise TopologyError(
                f"the sides of '{word}' end in {len(word.vertex_cycles)} vertices; a presentation needs a word with one"
            )
        return cls(tuple(sorted({abs(letter) for letter in word.letters})), word.letters)

    def __str__(self) -> str:
        """In the usual form, such as "<a, b | abAB>"."""
        return f"<{', '.join(map(text_of, self.generators))} | {''.join(map(text_of, self.relator))}>"

    @property
    def homology(self) -> tuple[int, int]:
        """The group made abelian: its rank r and the order t of its torsion, Z^r + Z/t; t is 1 where there is none.

        The relator is a row of exponents. The Smith normal form of a row is the greatest common divisor of its entries.
        """
        divisor = gcd(*(self.relator.count(g) - self.relator.count(-g) for g in self.generators))
        return (len(self.generators) - 1, divisor) if divisor else (len(self.generators), 1)

    @property
    def homology_text(self) -> str:
        """The homology in words, such as "Z^4" or "Z + Z/2"; "0" for the trivial group."""
        rank, torsion = self.homology
        free = ["Z" if rank == 1 else f"Z^{rank}"] if rank else []
        return " + ".join([*free, *([f"Z/{torsion}"] if torsion > 1 else [])]) or "0"
