"""Domains of splines: how many vertices they have at least."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import reference_surfaces as surfaces

from orbiframe import Orbifold
from orbiframe.delaunay.spline_domain import fewest_vertices


@pytest.mark.parametrize("chi", [2, 1, 0, -1, -2, -26, Fraction(-1, 42), Fraction(-9, 10), Fraction(1, 3)])
def test_triangles_are_on_average_no_larger_than_those_of_the_icosahedron(chi) -> None:
    """2 pi |chi| over 2 (V - chi) triangles; with one vertex less they would be larger."""
    count = fewest_vertices(Orbifold(surfaces.torus().atlas, chi, True, 1.0))
    assert np.pi * abs(chi) / (count - chi) <= np.pi / 5 * (1 + 1e-12) or chi == 0
    assert count == 1 or count - 1 == chi or np.pi * abs(chi) / (count - 1 - chi) > np.pi / 5
