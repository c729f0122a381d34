"""Matrices of the generators of a group: of its side pairings, and of the loops along the sides."""

from __future__ import annotations

from functools import reduce

from orbiframe import Group
from orbiframe.groups import PolygonGroup
from orbiframe.words import text_of
from orbiframe_invariants.polygon_loops import loops_in_pairings

Matrix = list[list[float]]


def generator_matrices(group: Group) -> dict[str, dict[str, Matrix]]:
    """The matrices "pairings" of the letters of the relations, and "loops" of those of the standard word.

    Of groups with cone points or mirrors, and of finite ones, the letters are the generators, and there are no loops.
    """
    letters = sorted({abs(letter) for letter in group.word.letters})
    if not isinstance(group, PolygonGroup) or hasattr(group, "signature"):
        chosen = group.relations.generators if hasattr(group, "relations") else letters
        return {"letters": {text_of(k): group.generator(k).tolist() for k in chosen}}
    pairings = {k: group.precise_generator(k) for k in letters}
    loops = {}
    for k, loop in sorted(loops_in_pairings(group.word).items()):
        steps = [pairings[a] if a > 0 else pairings[-a].inverse for a in loop]
        identity = pairings[k] @ pairings[k].inverse
        loops[text_of(k)] = reduce(lambda x, y: x @ y, steps, identity).matrix.tolist()
    return {"pairings": {text_of(k): found.matrix.tolist() for k, found in pairings.items()}, "loops": loops}
