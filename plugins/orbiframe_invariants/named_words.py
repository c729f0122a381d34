"""Gluing words with a name: the Bolza surface and the Klein quartic."""

from __future__ import annotations

from orbiframe import TopologyError, Word
from orbiframe.components import did_you_mean


def opposite_sides(size: int) -> Word:
    """The word that glues the opposite sides of a polygon with an even number of sides: abcdABCD for 8.

    With regular polygons: the square torus (4), the hexagonal torus (6), the Bolza surface (8), and on in steps of two;
    4g and 4g + 2 sides give genus g with one and two vertices. Raises TopologyError for an odd or small size.
    """
    if size < 4 or size % 2:
        raise TopologyError(f"a polygon with {size} sides has no opposite pairs to glue; use an even number from 4 on")
    half = tuple(range(1, size // 2 + 1))
    return Word(half + tuple(-k for k in half))


def klein_quartic() -> Word:
    """The word that glues side 2k of a 14-gon to side 2k + 5: genus 3, two vertices of seven corners each.

    The regular 14-gon with angles 2 pi / 7 makes it Klein's quartic, with 168 symmetries that keep orientation (Klein
    1879).
    """
    letters = [0] * 14
    for label, side in enumerate(range(0, 14, 2), start=1):
        letters[side], letters[(side + 5) % 14] = label, -label
    return Word(tuple(letters))


def word_named(text: str) -> Word:
    """The word of a name, `bolza` or `klein-quartic`, or the word as it is written.

    Raises TopologyError for a text that is neither.
    """
    named = {"bolza": opposite_sides(8), "klein-quartic": klein_quartic()}
    if text in named:
        return named[text]
    try:
        return Word.parse(text)
    except TopologyError as problem:
        near = did_you_mean(text, named)
        raise TopologyError(f"{problem}.{near}" if near else str(problem)) from None
