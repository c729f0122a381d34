"""Polygon loops: the loops along the sides of a glued polygon, as words in its side pairings."""

from __future__ import annotations

from collections.abc import Iterator

from orbiframe import Word
from orbiframe.words import inverse_letters, reduced_letters
from orbiframe_invariants.canonical_word import tree_letters

Letters = tuple[int, ...]


def pairing_letter(word: Word, side: int) -> int:
    """The letter of the pairing h_s of a side: the label, negative where h_s is the inverse of its generator."""
    label = abs(word.letters[side])
    return label if word.generator_side(label) == side else -label


def loops_in_pairings(word: Word) -> dict[int, Letters]:
    """For every letter of a gluing word the loop along its side, as a product of side pairings.

    Two presentations of one group have the same letters. A pairing h_s maps the mate of side s to s; a loop runs along
    a side on the surface, from vertex 0 of the polygon there and back along the tree that joins the vertices, as in
    `CanonicalWord`. The element of a loop along side i is t_i^-1 t_(i+1), where t_i takes the lift of the vertex that
    the tree begins with to corner i of the polygon. So the product of the loops round the polygon, the word itself, is
    1, and that of the pairings round a vertex, a relation of `Word.relations`, is 1.
    """
    place: dict[int, Letters] = {0: ()}
    waiting = [0]
    while waiting:
        corner = waiting.pop(0)
        for other, step in _steps(word, corner):
            if other not in place:
                place[other] = reduced_letters((*step, *place[corner]))
                waiting.append(other)
    size = len(word)
    found: dict[int, Letters] = {}
    for side, letter in enumerate(word.letters):
        loop = reduced_letters((*inverse_letters(place[side]), *place[(side + 1) % size]))
        found.setdefault(abs(letter), loop if letter > 0 else inverse_letters(loop))
    return found


def _steps(word: Word, corner: int) -> Iterator[tuple[int, Letters]]:
    """Corners that a corner is taken to by a pairing, with its letter, or along a side of the tree, with none."""
    size, tree = len(word), tree_letters(word)
    for side in ((corner - 1) % size, corner):
        at_start = side == corner
        mate = word.mate[side]
        # Mates that run against each other have their starts at each other's ends.
        there = mate if at_start == word.reverses(side) else (mate + 1) % size
        yield there, (pairing_letter(word, mate),)
        if abs(word.letters[side]) in tree:
            yield ((side + 1) % size if at_start else side), ()
