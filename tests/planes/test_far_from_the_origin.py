"""What is left of points, vectors and isometries of H^2 that are far from the origin."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from reference_geometries import GEOMETRIES

from orbiframe import GeometryError, Word
from orbiframe.groups import PolygonGroup, regular_polygon

H2 = GEOMETRIES[2]
far = st.floats(0, 9)
angles = st.floats(-np.pi, np.pi)


@pytest.mark.parametrize("distance", [10.0, 15.0, 18.0, 20.0])
def test_lengths_of_vectors_lose_one_power_only(distance):
    """The form v1 w1 + v2 w2 - v0 w0 has nothing left at 18, where eps e^(2 D) is 1."""
    x = H2.from_polar(distance, 0.3)
    v, w = (H2.frame(x) @ np.array(c) for c in ([0.7, 0.2], [0.1, -0.4]))
    allowed = 4 * np.finfo(float).eps * np.cosh(distance)
    assert H2.norm(x, v) == pytest.approx(np.hypot(0.7, 0.2), rel=allowed)
    assert H2.inner(x, v, w) == pytest.approx(0.07 - 0.08, abs=allowed)
    naive = np.sqrt(max(v[1] ** 2 + v[2] ** 2 - v[0] ** 2, 0.0))
    assert distance < 18 or abs(naive / np.hypot(0.7, 0.2) - 1) > 1e-2


@pytest.mark.parametrize("apart", [0.0, 1e-6, 1.0, 3.0])
@pytest.mark.parametrize("distance", [1.0, 100.0, 180.0, 340.0])
def test_distances_of_points_whose_squares_are_no_floats(distance, apart):
    """cosh d = cosh^2 D - sinh^2 D cos a, with 400 digits."""
    with mpmath.workdps(400):
        height, far = mpmath.cosh(distance), mpmath.sinh(distance)
        wanted = float(mpmath.acosh(max(height**2 - far**2 * mpmath.cos(mpmath.mpf(apart)), 1)))
    x, y = H2.from_polar(distance, 0.0), H2.from_polar(distance, apart)
    assert H2.distance(x, y) == pytest.approx(wanted, rel=1e-9)
    assert np.isfinite(H2.log(x, y)).all()


def test_a_geodesic_that_leaves_all_floats_is_an_error():
    x = H2.from_polar(60.0, 0.3)
    with pytest.raises(GeometryError, match=r"vector 0 has the length .* at distance 60 "):
        H2.exp(x, H2.frame(x) @ np.array([0.7, 0.2]))


# ---- kinds of motions -----------------------------------------------------------------------------------------------


def conjugated(distance: float, angle: float, g: np.ndarray) -> np.ndarray:
    t = H2.translation(distance, angle)
    return t @ g @ H2.inverse(t)


@settings(max_examples=60, deadline=None)
@given(far, angles, st.floats(0.3, np.pi))
def test_rotations_about_far_centres(distance, angle, turn):
    motion = H2.motion(conjugated(distance, angle, H2.rotation(turn)), 1e-12)
    allowed = 1e-14 * np.cosh(distance) ** 2
    assert motion.kind == "rotation"
    assert abs(np.angle(np.exp(1j * (motion.angle - turn)))) < 20 * allowed
    assert H2.distance(motion.point, H2.from_polar(distance, angle)) < 40 * allowed


@settings(max_examples=60, deadline=None)
@given(far, angles, st.floats(0.3, 3), angles, st.booleans())
def test_translations_and_glides_along_far_axes(distance, angle, length, direction, reverses):
    step = H2.glide(length, direction) if reverses else H2.translation(length, direction)
    motion = H2.motion(conjugated(distance, angle, step), 1e-12)
    assert motion.kind == ("glide" if reverses else "translation")
    assert motion.length == pytest.approx(length, abs=1e-12 * np.cosh(distance) ** 2)


@settings(max_examples=30, deadline=None)
@given(st.floats(0, 5), angles, st.floats(0.1, 2), angles)
def test_parabolic_motions_and_short_translations_are_told_apart(distance, angle, amount, direction):
    parabolic = conjugated(distance, angle, H2.parabolic(amount, direction))
    assert H2.motion(parabolic, 1e-12).kind == "parabolic"
    near = H2.motion(H2.translation(1e-5, direction))
    assert (near.kind, near.length) == ("translation", pytest.approx(1e-5, rel=1e-9))


def test_a_long_word_of_the_bolza_group_is_as_long_as_its_class():
    """dcbaBCD is conjugate to a, a translation by 2 arccosh(1 + sqrt 2), with entries of 6e7."""
    group = PolygonGroup(regular_polygon(H2, Word.parse("abcdABCD")))
    motion = H2.motion(group.element("dcbaBCD"))
    assert (motion.kind, motion.length) == ("translation", pytest.approx(3.05714183896, abs=1e-8))
