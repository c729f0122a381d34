"""Word: the boundary of a polygon read as letters, each side glued to the side with the same letter (section 2.5)."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from orbiframe.errors import TopologyError

_LETTER = re.compile(r"\s*([A-Za-z])(\d*)")


@dataclass(frozen=True)
class Word:
    """The gluing of the n sides of a polygon in pairs, n even.

    Side p runs counterclockwise from corner p to corner p + 1 (mod n). Sides with one label are glued along their
    arrows: a positive letter has its arrow counterclockwise, a negative letter clockwise. So `abAB` is a torus, `aabb`
    and `abaB` are Klein bottles. letters: nonzero integers, letter k or its inverse -k, each label twice. Raises
    TopologyError for a label that does not occur exactly twice.

    >>> from orbiframe import Word
    >>> word = Word.parse("abABcdCD")  # the octagon of genus 2
    >>> word.euler_characteristic, word.orientable, len(word.vertex_cycles)
    (-2, True, 1)
    >>> Word.parse("aabb").orientable
    False
    """

    letters: tuple[int, ...]

    def __post_init__(self) -> None:
        counts = Counter(abs(letter) for letter in self.letters)
        if not counts or 0 in counts:
            raise TopologyError("a gluing word needs letters, each twice; write for instance abAB for a torus")
        for label, count in counts.items():
            if count != 2:
                raise TopologyError(
                    f"letter '{text_of(label)}' occurs {count} time{'s' * (count != 1)} in '{self}', counting its "
                    "inverse; each letter glues two sides and must occur exactly twice"
                )

    @classmethod
    def parse(cls, text: str) -> Word:
        """The word of a text like "abABcdCD"; see `parse_letters`."""
        return cls(parse_letters(text))

    def __str__(self) -> str:
        return "".join(map(text_of, self.letters))

    def __len__(self) -> int:
        return len(self.letters)

    @cached_property
    def mate(self) -> tuple[int, ...]:
        """The side that every side is glued to, (n,)."""
        places: dict[int, list[int]] = {}
        for side, letter in enumerate(self.letters):
            places.setdefault(abs(letter), []).append(side)
        return tuple(sum(places[abs(letter)]) - side for side, letter in enumerate(self.letters))

    def reverses(self, side: int) -> bool:
        """Whether a side and its mate carry the same letter with the same sign: their pairing reverses orientation."""
        return self.letters[side] == self.letters[self.mate[side]]

    @property
    def orientable(self) -> bool:
        """Every letter meets its inverse."""
        return not any(self.reverses(side) for side in range(len(self)))

    @cached_property
    def vertex_cycles(self) -> tuple[tuple[int, ...], ...]:
        """The corners round each vertex of the glued surface, in the order in which one meets them."""
        return tuple(tuple(corner for corner, _ in cycle) for cycle in self._cycles)

    @cached_property
    def relations(self) -> tuple[tuple[int, ...], ...]:
        """For each vertex the sides that one crosses going round it; the product of their pairings is the identity.

        With h_s F the tile on the other side of s this is the Poincare relation h_s1 h_s2 ... h_sk = e (section 2.3).
        """
        return tuple(tuple(side for _, side in cycle) for cycle in self._cycles)

    def generator_side(self, label: int) -> int:
        """The side whose pairing a label stands for: the first one that carries the label and not its inverse."""
        return self.letters.index(label) if label in self.letters else self.mate[self.letters.index(-label)]

    @property
    def letter_relations(self) -> tuple[tuple[int, ...], ...]:
        """`relations` written in generators and their inverses: for `abAB` it is a B A b (up to rotation).

        The text of section 2.5 says a b a' b' ... = e; with h_s F the neighbour across s it is a b' a' b ... = e.
        """
        return tuple(tuple(map(self._letter_of, relation)) for relation in self.relations)

    def _letter_of(self, side: int) -> int:
        label = abs(self.letters[side])
        return label if side == self.generator_side(label) else -label

    @property
    def euler_characteristic(self) -> int:
        """Vertices minus edges plus the one face."""
        return len(self.vertex_cycles) - len(self) // 2 + 1

    @property
    def surface(self) -> str:
        """The name of the glued surface: "sphere", "torus", "genus 2", "projective plane", "Klein bottle", ..."""
        deficit = 2 - self.euler_characteristic
        if self.orientable:
            return {0: "sphere", 2: "torus"}.get(deficit, f"genus {deficit // 2}")
        return {1: "projective plane", 2: "Klein bottle"}.get(deficit, f"{deficit} crosscaps")

    @property
    def standard(self) -> Word:
        """The standard word of the same surface: `aA`, `abABcdCD...` or `aabbcc...`."""
        return standard_word(self.euler_characteristic, self.orientable)

    @property
    def inverse(self) -> Word:
        """The word read backwards along the boundary: the mirrored polygon."""
        return Word(inverse_letters(self.letters))

    @cached_property
    def _cycles(self) -> tuple[tuple[tuple[int, int], ...], ...]:
        """(corner, side by which one leaves it) round each vertex, starting counterclockwise at its first corner."""
        seen: set[int] = set()
        cycles = []
        for corner in range(len(self)):
            if corner not in seen:
                cycle = tuple(self._walk(corner))
                seen.update(c for c, _ in cycle)
                cycles.append(cycle)
        return tuple(cycles)

    def _walk(self, first: int) -> Iterable[tuple[int, int]]:
        size = len(self)
        side, end = (first - 1) % size, 1
        while True:
            yield (side + end) % size, side
            side, end = self._across(side, end)
            if (side + end) % size == first:
                return

    def _across(self, side: int, end: int) -> tuple[int, int]:
        """The next side round the vertex at an end of a side, 0 its start, 1 its end, and which of its ends is there.

        The end of the side is glued to the same end of its mate, or to the other; the next side is the one beside it.
        """
        size, mate = len(self), self.mate[side]
        arrival = end if self.reverses(side) else 1 - end
        return ((mate + 1) % size, 0) if arrival else ((mate - 1) % size, 1)


def standard_word(euler_characteristic: int, orientable: bool) -> Word:
    """The standard word of a closed surface: `aA`, `abABcdCD...` (g handles) or `aabbcc...` (g crosscaps).

    Raises TopologyError if no closed surface has this Euler characteristic.

    >>> from orbiframe.words import standard_word
    >>> print(standard_word(-2, True), standard_word(-1, False))
    abABcdCD aabbcc
    """
    deficit = 2 - euler_characteristic
    if deficit < 0 or (orientable and deficit % 2) or not (orientable or deficit):
        kind = "orientable" if orientable else "nonorientable"
        raise TopologyError(f"no closed connected {kind} surface has Euler characteristic {euler_characteristic}")
    if deficit == 0:
        return Word((1, -1))
    if not orientable:
        return Word(tuple(k for label in range(1, deficit + 1) for k in (label, label)))
    return Word(tuple(k for a in range(1, deficit + 1, 2) for k in (a, a + 1, -a, -a - 1)))


def parse_letters(text: str) -> tuple[int, ...]:
    """Signed letters of a text: a, b, ..., z are 1 to 26, a1, ..., z1 the next 26, upper case is the inverse.

    Letters need not come in pairs: the text names an element of a group. Raises TopologyError at a foreign character.
    """
    letters, place = [], 0
    while place < len(text.rstrip()):
        found = _LETTER.match(text, place)
        if not found:
            raise TopologyError(
                f"character {place + 1} of '{text}' is '{text[place:].strip()[0]}'; a word has letters like a or B, "
                "upper case for the inverse, with a number after z: a1, B1"
            )
        letter, number = found.groups()
        label = ord(letter.lower()) - ord("a") + 1 + 26 * int(number or 0)
        letters.append(label if letter.islower() else -label)
        place = found.end()
    return tuple(letters)


def inverse_letters(letters: Iterable[int]) -> tuple[int, ...]:
    """The letters of the inverse element: reversed, each inverted."""
    return tuple(-letter for letter in reversed(tuple(letters)))


def reduced_letters(letters: Iterable[int]) -> tuple[int, ...]:
    """The letters without neighbours that cancel (free reduction).

    >>> from orbiframe.words import reduced_letters
    >>> reduced_letters((1, 2, -2, 3))
    (1, 3)
    """
    kept: list[int] = []
    for letter in letters:
        if kept and kept[-1] == -letter:
            kept.pop()
        else:
            kept.append(letter)
    return tuple(kept)


def text_of(letter: int) -> str:
    """The text of one letter: a to z, a1 to z1, ..., upper case for the inverse."""
    number, place = divmod(abs(letter) - 1, 26)
    name = chr(ord("a") + place)
    return (name if letter > 0 else name.upper()) + (str(number) if number else "")
