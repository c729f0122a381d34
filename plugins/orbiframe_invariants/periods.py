"""Periods: the period matrix of X/H in the letters of its standard word."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from orbiframe import Group, TopologyError, Word
from orbiframe.delaunay import polygon_triangulation
from orbiframe.groups import PolygonGroup
from orbiframe.splines import ElementBasis
from orbiframe.surfaces import HarmonicForms, PeriodMatrix, period_matrix
from orbiframe.triangulations import GeodesicTriangulation, refined_jumps
from orbiframe_invariants.canonical_word import canonical_form, substituted
from orbiframe_invariants.polygon_loops import loops_in_pairings, pairing_letter

Ints = NDArray[np.intp]
Family = Callable[[GeodesicTriangulation, int], ElementBasis]

_LONGEST_EDGE = 1.0
_DEGREES = (4, 6, 8, 10)
# Where the bound of the error is no larger, no higher degree is tried.
_ENOUGH = 1e-11


def group_periods(group: Group, family: Family) -> PeriodMatrix:
    """The period matrix of X/H, a_i and b_i being the letters 2 i - 1 and 2 i of the standard word of its surface.

    family: continuous polynomials of an even degree on a triangulation. The degree is raised until the bound of the
    error is 1e-11, as far as 10. Raises TopologyError for nonorientable surfaces and for spheres.
    """
    domain, word = polygon_triangulation(group), group.word
    if not domain.orbifold.orientable:
        raise TopologyError(
            f"the {word.surface} of '{word}' is nonorientable: it has harmonic 1-forms, but no holomorphic ones and no "
            "period matrix; take a word in which every letter occurs once with each sign"
        )
    own = isinstance(group, PolygonGroup) and not hasattr(group, "signature")
    jumps = _jumps(word, domain) if own else None
    while domain.edge_lengths.max() > _longest(domain):
        domain, jumps = domain.refined(), None if jumps is None else refined_jumps(jumps)
    for degree in _DEGREES:
        found = period_matrix(HarmonicForms.on_x(family(domain, degree), jumps))
        if found.error <= _ENOUGH:
            break
    return found


def _longest(domain: GeodesicTriangulation) -> float:
    """In the flat plane harmonic functions are linear, and any triangles will do."""
    return _LONGEST_EDGE if domain.geometry.curvature else np.inf


def _jumps(word: Word, domain: GeodesicTriangulation) -> Ints:
    """The jumps (2 g, 3 F) on the fan of a polygon, whose triangle k has side k as its first edge."""
    values = standard_classes(word)
    found = np.zeros((len(values), 3 * domain.face_count), dtype=np.intp)
    found[:, ::3] = values
    return found


def standard_classes(word: Word) -> Ints:
    """The homomorphisms of H to the integers that are 1 on one letter of the standard word and 0 on the others.

    Their values on the side pairings h_s, (2 g, n), in the order a_1, ..., a_g, b_1, ..., b_g. Of an orientable word.
    """
    loops, form = loops_in_pairings(word), canonical_form(word)
    labels = sorted({abs(letter) for letter in word.letters})
    letters = [substituted(form.new_in_old[k], loops) for k in sorted(form.new_in_old)]
    rows = [_exponents(letters[k], labels) for k in [*range(0, len(letters), 2), *range(1, len(letters), 2)]]
    relations = [_exponents(relation, labels) for relation in word.letter_relations]
    wanted = np.concatenate([np.eye(len(rows)), np.zeros((len(relations), len(rows)))])
    solved = np.linalg.lstsq(np.array(rows + relations, dtype=float).reshape(-1, len(labels)), wanted, rcond=None)[0]
    values = np.rint(solved.T).astype(np.intp)
    return np.stack([_of_side(word, values, labels, side) for side in range(len(word))], axis=1)


def _of_side(word: Word, values: Ints, labels: list[int], side: int) -> Ints:
    letter = pairing_letter(word, side)
    return values[:, labels.index(abs(letter))] * (1 if letter > 0 else -1)


def _exponents(letters: tuple[int, ...], labels: list[int]) -> list[int]:
    """How often each letter occurs, inverses counted as -1."""
    return [letters.count(k) - letters.count(-k) for k in labels]
