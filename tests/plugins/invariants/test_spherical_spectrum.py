"""Spectra of finite groups: against the series of their invariants (B. Meyer, 1954; Molien) and known spheres."""

from __future__ import annotations

import json

import numpy as np
import pytest
from orbiframe_invariants.spherical_spectrum import invariant_harmonics

from orbiframe.components.registry import Registry
from orbiframe.groups import orbifold_group
from orbiframe.words import ConwaySymbol

REGISTRY = Registry.discover()
# Numerator and the two degrees of the denominator: numbers of invariant harmonics of each degree.
SERIES = {
    "332": ([0, 6], 3, 4),
    "432": ([0, 9], 4, 6),
    "532": ([0, 15], 6, 10),
    "*332": ([0], 3, 4),
    "*432": ([0], 4, 6),
    "*532": ([0], 6, 10),
    "*22N": ([0], 2, 5),
}


def coefficients(numerator: list[int], first: int, second: int, count: int) -> list[int]:
    """Of the sum of t^n over the numerator, over (1 - t^first)(1 - t^second)."""
    series = np.zeros(count, dtype=int)
    for n in numerator:
        for a in range(n, count, first):
            for b in range(a, count, second):
                series[b] += 1
    return series.tolist()


@pytest.mark.parametrize("symbol", SERIES)
def test_invariants_are_those_of_the_series(symbol):
    group = orbifold_group(REGISTRY.geometry(1), ConwaySymbol.parse(symbol.replace("N", "5")))
    found = [invariant_harmonics(group.elements, degree) for degree in range(40)]
    assert found == coefficients(*SERIES[symbol], 40)


def test_the_sphere_and_the_projective_plane(orbiframe):
    for symbol, expected in (("1", [(0, 1), (2, 3), (6, 5)]), ("x", [(0, 1), (6, 5), (20, 9)])):
        ran = orbiframe("group", symbol, "--spectrum", 3, "--json")
        assert (ran.status, ran.err) == (0, "")
        assert [(e["value"], e["multiplicity"]) for e in json.loads(ran.out)["spectrum"]] == expected
