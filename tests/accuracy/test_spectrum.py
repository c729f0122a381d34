"""Spectra of closed surfaces against closed forms and published numbers."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from orbiframe_bases.bernstein import Bernstein
from orbiframe_geometries.e2 import E2
from orbiframe_geometries.h2 import H2
from orbiframe_geometries.s2 import S2
from orbiframe_groups.finite import FiniteGroup
from orbiframe_groups.lattice import lattice_group
from orbiframe_groups.regular_polygon import regular_polygon_group
from orbiframe_invariants.laplace_spectrum import laplace_spectrum

from orbiframe.delaunay.polygon_fan import polygon_triangulation
from orbiframe.errors import FitError
from orbiframe.words.word import Word

pytestmark = pytest.mark.long

PI2 = np.pi**2
# Strohmaier and Uski (2013) for the Bolza surface; closed forms for the sphere and flat surfaces.
BOLZA = [0, 3.8388872588421995, 5.3536013411890504, 8.2495548152006581, 14.726216787788832, 15.048916133267047]
# The paper's word on the regular octagon, another surface; computed elsewhere to nine digits.
PAPER = [1.724863804, 3.838887259, 4.035491714, 5.372814500, 7.160197861, 8.249554815]
KNOWN = {
    "aA": (S2, FiniteGroup, [0, 2, 6, 12, 20], [1, 3, 5, 7, 9]),
    "aa": (S2, FiniteGroup, [0, 6, 20, 42], [1, 5, 9, 13]),
    "abAB": (E2, lattice_group, [0, 4 * PI2, 8 * PI2, 16 * PI2, 20 * PI2], [1, 4, 4, 4, 8]),
    "abaB": (E2, lattice_group, [0, 4 * PI2, 5 * PI2], [1, 3, 2]),
    "aabb": (E2, lattice_group, [0, 2 * PI2, 4 * PI2, 8 * PI2, 10 * PI2], [1, 1, 2, 3, 4]),
    "abABcdCD": (H2, regular_polygon_group, [0, *PAPER], [1, 1, 1, 1, 1, 2, 2]),
    "abcdABCD": (H2, regular_polygon_group, BOLZA, [1, 3, 4, 2, 4, 3]),
}


@cache
def spectrum(text, count, **options):
    geometry, group, *_ = KNOWN[text]
    domain = polygon_triangulation(group(geometry(), Word.parse(text)))
    return laplace_spectrum(domain, lambda d, degree: Bernstein(d.orbifold, d, degree=degree), count, **options)


@pytest.mark.parametrize("text", KNOWN)
def test_eigenvalues_and_multiplicities_are_the_known_ones(text):
    _, _, values, multiplicities = KNOWN[text]
    found = spectrum(text, len(values))
    assert [e.multiplicity for e in found] == multiplicities
    np.testing.assert_allclose([e.value for e in found], values, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("text", KNOWN)
@pytest.mark.parametrize("degree", [6, 10, 14])
def test_the_error_bounds_what_is_missing(text, degree):
    """Of every surface and degree, down to rounding, and not much more than that."""
    values = KNOWN[text][2]
    sure = 0 if text != "abABcdCD" else 1e-9  # known to nine digits
    for e, exact in zip(spectrum(text, len(values), degree=degree), values, strict=True):
        assert abs(e.value - exact) <= e.error + sure
        assert e.error <= (2e-12 * max(exact, 1) if degree == 14 else 0.01)


def test_bolza_to_twelve_digits():
    """A tolerance is met by what is there and by what is said."""
    zero, first = spectrum("abcdABCD", 2, tolerance=1e-12)
    assert (zero.value, zero.error) == (0, 0)
    assert first.error <= 1e-12 * first.value
    assert abs(first.value - BOLZA[1]) < 1e-12 * BOLZA[1]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"count": 0}, "at least 1"),
        ({"count": 2, "degree": 7}, "even, from 4 to 14"),
        ({"count": 2, "degree": 16}, "even, from 4 to 14"),
        ({"count": 2, "tolerance": 1e-17}, "is not met: the error is"),
    ],
)
def test_what_cannot_be_is_an_error(options, said):
    with pytest.raises(FitError, match=said):
        spectrum("aA", **options)
