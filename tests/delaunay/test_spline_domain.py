"""Domains of splines: how many vertices they have at least."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import reference_surfaces as surfaces

from orbiframe import Orbifold
from orbiframe.delaunay.spline_domain import fewest_vertices, spline_domain
from orbiframe.testing.reference import reference_triangulations


@pytest.mark.parametrize("chi", [2, 1, 0, -1, -2, -26, Fraction(-1, 42), Fraction(-9, 10), Fraction(1, 3)])
def test_triangles_are_on_average_no_larger_than_those_of_the_icosahedron(chi) -> None:
    """2 pi |chi| over 2 (V - chi) triangles; with one vertex less they would be larger."""
    count = fewest_vertices(Orbifold(surfaces.torus().atlas, chi, True, 1.0))
    assert np.pi * abs(chi) / (count - chi) <= np.pi / 5 * (1 + 1e-12) or chi == 0
    assert count == 1 or count - 1 == chi or np.pi * abs(chi) / (count - 1 - chi) > np.pi / 5


@pytest.mark.parametrize("name", ["tetrahedron", "projective plane"])
def test_the_edges_of_coarse_domains_on_the_sphere_are_shorter_than_a_quarter_of_a_great_circle(name) -> None:
    made = reference_triangulations()[name]
    least = fewest_vertices(made.orbifold)
    for count in (least, least + 1, least + 3):
        domain = spline_domain(made, count)
        assert domain.vertex_count == count
        assert domain.edge_lengths.max() < 0.96 * np.pi / 2
