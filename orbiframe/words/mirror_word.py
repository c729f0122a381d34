"""MirrorWord: the boundary of a polygon whose sides are glued in pairs or are mirrors."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import count

from orbiframe.errors import TopologyError
from orbiframe.words.conway_symbol import ConwaySymbol
from orbiframe.words.word import Word, inverse_letters, reduced_letters, text_of

Letters = tuple[int, ...]
End = tuple[int, int]


@dataclass(frozen=True)
class Cycle:
    """The corners round one vertex of the folded polygon.

    corners: in the order in which one meets them; crossed: the sides that one crosses, of a cone point as many as
    corners, between mirrors one less; ends: of a chain between two mirrors the mirror sides at both its ends, each with
    0 if the vertex is its start and 1 if it is its end, and empty for a cone point or an ordinary point.
    """

    corners: tuple[int, ...]
    crossed: tuple[int, ...]
    ends: tuple[End, ...] = ()


class MirrorWord(Word):
    """A gluing word in which a letter may also occur once: its side is a mirror, paired with itself by its reflection.

    So `abc` is a triangle of mirrors, `aAbBcC` a sphere with three cone points at the corners between a letter and its
    inverse, `aAbcdB` a cone point and a mirror boundary with one corner. `euler_characteristic` is that of the glued
    surface, whose boundary are the mirrors. Raises TopologyError for a label that occurs more than twice.
    """

    def __post_init__(self) -> None:
        counts = Counter(abs(letter) for letter in self.letters)
        if not counts or 0 in counts:
            raise TopologyError("a word needs letters, twice for a glued pair of sides and once for a mirror")
        for label, times in counts.items():
            if times > 2:
                raise TopologyError(
                    f"letter '{text_of(label)}' occurs {times} times in '{self}', counting its inverse; it may occur "
                    "twice, for two sides that are glued, or once, for a mirror"
                )

    @cached_property
    def mate(self) -> tuple[int, ...]:
        """The side that every side is glued to, (n,); a mirror is its own mate."""
        places: dict[int, list[int]] = {}
        for side, letter in enumerate(self.letters):
            places.setdefault(abs(letter), []).append(side)
        found = (places[abs(letter)] for letter in self.letters)
        return tuple(sum(pair) - side if len(pair) == 2 else side for side, pair in enumerate(found))

    @property
    def mirrors(self) -> tuple[int, ...]:
        """The sides that are mirrors."""
        return tuple(side for side, mate in enumerate(self.mate) if side == mate)

    @cached_property
    def cycles(self) -> tuple[Cycle, ...]:
        """The vertices: chains from mirror to mirror first, then closed cycles."""
        chains = list(self._chains())
        seen = {corner for chain in chains for corner in chain.corners}
        closed = list[Cycle]()
        for first in range(len(self)):
            if first not in seen:
                corners, sides = zip(*self._walk(first), strict=True)
                seen.update(corners)
                closed.append(Cycle(corners, sides))
        return (*chains, *closed)

    @cached_property
    def vertex_cycles(self) -> tuple[tuple[int, ...], ...]:
        """The corners round each vertex, in the order of `cycles`."""
        return tuple(cycle.corners for cycle in self.cycles)

    @cached_property
    def relations(self) -> tuple[tuple[int, ...], ...]:
        """For each vertex the sides that one crosses going once round it, over its mirrors and back where it has any.

        The product of their pairings is a rotation about the vertex, by 2 pi / n for a point of order n.
        """
        return tuple(tuple(self._crossings(cycle)) for cycle in self.cycles)

    def signature(self, orders: Iterable[int]) -> ConwaySymbol:
        """The orbifold, if the vertices, in the order of `cycles`, have these orders, 1 for an ordinary point."""
        order = dict(zip(self.cycles, orders, strict=True))
        cones = tuple(n for cycle, n in order.items() if not cycle.ends and n > 1)
        boundaries = tuple(tuple(order[c] for c in loop if order[c] > 1) for loop in self._boundaries())
        reverses = any(self.reverses(side) for side in range(len(self)) if side not in self.mirrors)
        deficit = 2 - self.euler_characteristic - len(boundaries)
        genus = (0, deficit) if reverses else (deficit // 2, 0)
        return ConwaySymbol(genus[0], cones, boundaries, genus[1])

    @property
    def euler_characteristic(self) -> int:
        """Vertices minus edges plus the one face, of the glued surface with its boundary."""
        return len(self.cycles) - len({abs(letter) for letter in self.letters}) + 1

    def _chains(self) -> Iterator[Cycle]:
        seen = set[End]()
        for start in ((mirror, end) for mirror in self.mirrors for end in (0, 1)):
            if start not in seen:
                chain = self._chain(*start)
                seen.update(chain.ends)
                yield chain

    def _chain(self, mirror: int, end: int) -> Cycle:
        """The chain that begins at an end of a mirror."""
        size = len(self)
        corners, crossed = [(mirror + end) % size], list[int]()
        side, at = ((mirror + 1) % size, 0) if end else ((mirror - 1) % size, 1)
        while self.mate[side] != side:
            crossed.append(side)
            side, at = self._across(side, at)
            corners.append((side + at) % size)
        return Cycle(tuple(corners), tuple(crossed), ((mirror, end), (side, at)))

    def _crossings(self, cycle: Cycle) -> Iterator[int]:
        if not cycle.ends:
            yield from cycle.crossed
            return
        (first, _), (last, _) = cycle.ends
        yield from (first, *cycle.crossed, last)
        yield from (self.mate[side] for side in reversed(cycle.crossed))

    def _boundaries(self) -> list[list[Cycle]]:
        """The chains along each mirror boundary, in order."""
        at = {end: cycle for cycle in self.cycles for end in cycle.ends}
        loops, left = [], set(at)
        for mirror in self.mirrors:
            loop, end = list[Cycle](), (mirror, 1)
            while end in left:
                cycle = at[end]
                other = cycle.ends[cycle.ends[0] == end]
                loop.append(cycle)
                left -= {end, other}
                end = (other[0], 1 - other[1])
            loops += [loop] if loop else []
        return loops


@dataclass(frozen=True)
class Relations:
    """A presentation by powers: generators, and words in them with an exponent each, w^n = 1.

    Poincare's theorem: the side pairings generate the group, and the relations are r^2 for the mirrors and for every
    vertex the n-th power of the way once round it.
    """

    generators: tuple[int, ...]
    powers: tuple[tuple[Letters, int], ...]

    @classmethod
    def of(cls, word: MirrorWord, orders: Iterable[int]) -> Relations:
        """The relations of a polygon whose vertices, in the order of `word.cycles`, have these orders."""
        mirrors = {abs(word.letters[side]) for side in word.mirrors}
        powers: dict[tuple[Letters, int], None] = {((label,), 2): None for label in sorted(mirrors)}
        for letters, order in zip(word.letter_relations, orders, strict=True):
            plain = tuple(abs(k) if abs(k) in mirrors else k for k in letters)
            kept = reduced_letters(plain)
            # A mirror that meets itself, as the only side of a disc, says nothing new.
            if kept and not (len(set(kept)) == 1 and kept[0] in mirrors):
                powers[min(kept, inverse_letters(kept), key=_capitals), order] = None
        return cls(tuple(sorted({abs(k) for k in word.letters})), tuple(powers))

    @property
    def texts(self) -> tuple[str, ...]:
        """Each relator in the usual form, such as "a^2" or "(ab)^3"."""
        return tuple(_power_text("".join(map(text_of, letters)), n) for letters, n in self.powers)

    def __str__(self) -> str:
        """In the usual form, such as "<a, b | a^2, b^2, (ab)^5>"."""
        return f"<{', '.join(map(text_of, self.generators))} | {', '.join(self.texts)}>"


def word_of(signature: ConwaySymbol) -> tuple[MirrorWord, tuple[int, ...]]:
    """A polygon's word for an orbifold, and the order of each of its vertices in the order of `cycles`.

    A handle is abAB, a crosscap aa, a cone point aA, a mirror boundary with k corners a b...c A with k + 1 mirrors; all
    else about a disc of mirrors, which is its own polygon. All other corners are glued to one ordinary point.
    """
    label, letters, order = count(1), list[int](), dict[int, int]()
    if len(signature.mirrors) == 1 and not (signature.handles or signature.crosscaps or signature.cones):
        corners = signature.mirrors[0]
        letters, order = [next(label) for _ in corners or (1,)], dict(enumerate(corners))
        return _with_orders(letters, order)
    for _ in range(signature.handles):
        a, b = next(label), next(label)
        letters += [a, b, -a, -b]
    for n in signature.cones or ((1,) if signature == ConwaySymbol() else ()):
        a = next(label)
        order[len(letters) + 1] = n
        letters += [a, -a]
    for corners in signature.mirrors:
        a = next(label)
        order |= {len(letters) + 2 + k: m for k, m in enumerate(corners)}
        letters += [a, *(next(label) for _ in range(len(corners) + 1)), -a]
    for _ in range(signature.crosscaps):
        a = next(label)
        letters += [a, a]
    return _with_orders(letters, order)


def _with_orders(letters: list[int], order: dict[int, int]) -> tuple[MirrorWord, tuple[int, ...]]:
    word = MirrorWord(tuple(letters))
    return word, tuple(max(order.get(corner, 1) for corner in cycle.corners) for cycle in word.cycles)


def _capitals(letters: Letters) -> int:
    return sum(letter < 0 for letter in letters)


def _power_text(text: str, exponent: int) -> str:
    if exponent == 1:
        return text
    return f"({text})^{exponent}" if len(text) > 1 else f"{text}^{exponent}"
