from math import factorial

import numpy as np
import pytest
from reference_geometries import GEOMETRIES, random_points

from orbiframe import Word
from orbiframe.groups import regular_polygon
from orbiframe.planes import triangle_points, triangle_rule

S2, E2, H2 = GEOMETRIES


@pytest.mark.parametrize("n", [1, 2, 3, 5, 8])
def test_rule_is_exact_to_degree_2n_minus_1(n):
    """The mean of l1^a l2^b l3^c over a triangle is 2 a! b! c! / (a + b + c + 2)!."""
    points, weights = triangle_rule(n)
    assert points.shape == (n * n, 3)
    assert (points > 0).all()
    assert (weights > 0).all()
    np.testing.assert_allclose(points.sum(axis=1), 1.0)
    for a in range(2 * n):
        for b in range(2 * n - a):
            c = 2 * n - 1 - a - b
            mean = 2 * factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 2)
            assert weights @ np.prod(points ** [a, b, c], axis=1) == pytest.approx(mean, rel=1e-12)


@pytest.mark.parametrize(
    ("n", "error"), [(2, 2e-1), (4, 3e-3), (6, 4e-5), (8, 1e-7), (10, 1e-9), (14, 1e-10), (20, 3e-15)]
)
def test_area_of_the_octant_of_the_sphere(n, error):
    x, weights = triangle_points(S2, np.eye(3)[None], n)
    assert S2.point_defect(x).max() < 1e-15
    assert abs(weights.sum() / (np.pi / 2) - 1) < error


@pytest.mark.parametrize(("n", "error"), [(2, 1e-1), (4, 5e-3), (8, 3e-5), (14, 3e-8), (20, 2e-11), (28, 3e-14)])
def test_area_of_the_octagon_cut_at_the_middles_of_its_sides(n, error):
    """Sixteen triangles from the centre over half a side, edges up to 2.45: 4 pi by Gauss and Bonnet."""
    octagon = regular_polygon(H2, Word.parse("abcdABCD"))
    middles = H2.geodesic(octagon.vertices, octagon.heads, 0.5)
    centre = np.tile(H2.origin, (8, 1))
    halves = [np.stack(c, axis=1) for c in ((centre, octagon.vertices, middles), (centre, middles, octagon.heads))]
    x, weights = triangle_points(H2, np.concatenate(halves), n)
    assert H2.point_defect(x).max() < 1e-14
    assert abs(weights.sum() / (4 * np.pi) - 1) < error


@pytest.mark.parametrize("geometry", GEOMETRIES, ids=lambda g: g.name)
def test_small_triangles_against_the_angle_formula(geometry):
    rng = np.random.default_rng(4)
    x = random_points(geometry, rng, 10)
    corners = [x] + [geometry.exp(x, 1e-4 * geometry.frame(x)[..., k]) for k in range(2)]
    _, weights = triangle_points(geometry, np.stack(corners, axis=1), 3)
    np.testing.assert_allclose(weights.sum(axis=1), geometry.triangle_area(*corners), rtol=1e-11)


def test_polynomials_over_a_flat_triangle():
    corners = np.array([[[1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [1.0, 0.0, 3.0]]])
    x, weights = triangle_points(E2, corners, 2)
    # The integral of u v over the triangle (0,0), (a,0), (0,b) is a^2 b^2 / 24.
    assert (weights * x[..., 1] * x[..., 2]).sum() == pytest.approx(4 * 9 / 24)


def test_integral_of_a_function_over_the_sphere():
    """The mean of x1^4 over the sphere is 1/5, summed over the eight octants."""
    signs = np.array(np.meshgrid([1, -1], [1, -1], [1, -1])).reshape(3, 8).T
    x, weights = triangle_points(S2, np.eye(3) * signs[:, :, None], 16)
    assert (weights * x[..., 1] ** 4).sum() / (4 * np.pi) == pytest.approx(0.2, rel=1e-9)
