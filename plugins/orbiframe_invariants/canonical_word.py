"""Canonical words: any gluing word reduced to the standard word of its surface, with the change of generators."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from orbiframe import Word
from orbiframe.words import inverse_letters, reduced_letters

Letters = tuple[int, ...]
Change = dict[int, Letters]


@dataclass(frozen=True)
class CanonicalWord:
    """The standard word of a surface, and its letters as loops in the letters of another word, and back.

    A letter is the loop along its sides; the word itself, read round the polygon, is trivial. Where the given word has
    several vertices, the letters of a tree that joins them are trivial and the others stand for the loops that go there
    and back along the tree. word: as given; standard: `aA`, `abABcdCD...` or `aabbcc...`; new_in_old: for every letter
    of the standard word its loop; old_in_new: for every letter of the given word, empty for those of the tree. In the
    free group one undoes the other, and each takes one word to a conjugate of the other or of its inverse.
    """

    word: Word
    new_in_old: Change
    old_in_new: Change

    @cached_property
    def standard(self) -> Word:
        """The standard word."""
        return self.word.standard


def canonical_form(word: Word) -> CanonicalWord:
    """Reduce a word by the cuts of the classification of surfaces, each of which names one letter anew.

    Letters grow with the number of cuts, to some hundred for a word of twenty.
    """
    tree = tree_letters(word)
    cuts = _Cuts([letter for letter in word.letters if abs(letter) not in tree], tree)
    cuts.find_crosscaps()
    cuts.find_handles()
    cuts.turn_handles_into_crosscaps()
    return CanonicalWord(word, *cuts.renamed(word.standard.letters))


def substituted(letters: Iterable[int], change: Change) -> Letters:
    """A word with every letter replaced by its word, freely reduced."""
    return reduced_letters(k for a in letters for k in (change[a] if a > 0 else inverse_letters(change[-a])))


def tree_letters(word: Word) -> set[int]:
    """Letters whose sides join all vertices without a circle."""
    vertex = {corner: number for number, cycle in enumerate(word.vertex_cycles) for corner in cycle}
    tree = set[int]()
    for side, letter in enumerate(word.letters):
        start, end = vertex[side], vertex[(side + 1) % len(word)]
        if start != end:
            tree.add(abs(letter))
            vertex = {corner: start if v == end else v for corner, v in vertex.items()}
    return tree


class _Cuts:
    """A word under cuts: crosscaps dd and handles abAB that are done, before a rest that is not.

    new: the present letters in those of the start; old: those of the start in the present ones.
    """

    def __init__(self, letters: list[int], trivial: set[int]) -> None:
        self.rest = tuple(letters)
        self.crosscaps: list[int] = []
        self.handles: list[tuple[int, int]] = []
        self.new: Change = {abs(k): (abs(k),) for k in letters}
        self.old: Change = dict(self.new)
        self.trivial = trivial

    def find_crosscaps(self) -> None:
        """As long as some letter occurs twice with one sign, make a crosscap of it."""
        while (letter := next((k for k in self.rest if self.rest.count(k) == 2), None)) is not None:
            self._crosscap(letter)

    def _crosscap(self, letter: int) -> None:
        """U a X a Y = cc U X' Y with c = U a X U'."""
        before, rest = _until(self.rest, letter)
        between, after = _until(rest, letter)
        self._rename(letter, before, between + inverse_letters(before))
        self.crosscaps.append(letter)
        self.rest = before + inverse_letters(between) + after

    def find_handles(self) -> None:
        """a X b Y A Z B T = cdCD Q X T with Q = Z Y, c = a Q', d = Q X b Y Q'."""
        while self.rest:
            a, b = self.rest[0], self._crossing(self.rest)
            x, rest = _until(self.rest[1:], b)
            y, rest = _until(rest, -a)
            z, t = _until(rest, -b)
            q = z + y
            self._rename(b, q + x, y + inverse_letters(q))
            self._rename(a, (), inverse_letters(q))
            self.handles.append((a, b))
            self.rest = q + x + t

    def turn_handles_into_crosscaps(self) -> None:
        """cc abAB is three crosscaps: with d = c a b it is d B A d A B, where every letter occurs twice alike."""
        while self.handles and self.crosscaps:
            (a, b), c = self.handles.pop(0), self.crosscaps.pop()
            # d = c a b, so that c c a b A B = d B A d A B.
            self._rename(c, (), (a, b))
            self.rest = (c, -b, -a, c, -a, -b)
            self._crosscap(-b)
            self.find_crosscaps()

    def renamed(self, standard: Letters) -> tuple[Change, Change]:
        """The changes to and from the standard letters 1, 2, ..."""
        order = self.crosscaps or [k for pair in self.handles for k in pair]
        number = {abs(k): (place + 1) * (1 if k > 0 else -1) for place, k in enumerate(order)}
        new = {abs(n): self.new[k] if n > 0 else inverse_letters(self.new[k]) for k, n in number.items()}
        for label in set(map(abs, standard)) - set(new):
            new[label] = ()
        signs: Change = {k: (n,) for k, n in number.items()}
        old = {k: substituted(letters, signs) for k, letters in self.old.items()}
        return new, dict(sorted((old | dict.fromkeys(self.trivial, ())).items()))

    def _rename(self, letter: int, before: Letters, after: Letters) -> None:
        """Let a letter stand for before . letter . after from now on, in letters that stay as they are."""
        named = substituted((*before, letter, *after), self.new)
        self.new[abs(letter)] = named if letter > 0 else inverse_letters(named)
        undone = (*inverse_letters(before), letter, *inverse_letters(after))
        change: Change = {k: (k,) for k in self.new}
        change[abs(letter)] = undone if letter > 0 else inverse_letters(undone)
        self.old = {k: substituted(letters, change) for k, letters in self.old.items()}

    @staticmethod
    def _crossing(rest: Letters) -> int:
        """A letter b with the first letter a in the order a b A B; in a word with one vertex there is one."""
        between, _ = _until(rest[1:], -rest[0])
        return next(b for b in between if -b not in between)


def _until(letters: Letters, stop: int) -> tuple[Letters, Letters]:
    """What stands before a letter, and what follows it."""
    place = letters.index(stop)
    return letters[:place], letters[place + 1 :]
