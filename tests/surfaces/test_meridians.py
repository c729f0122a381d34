"""Meridians and parallels."""

from __future__ import annotations

import numpy as np
import pytest
from fitted import round_sphere
from orbiframe_geometries.s2 import S2

from orbiframe.surfaces.meridians import meridians_and_parallels

SPHERE = round_sphere(1.0)
CORNERS = SPHERE.vertices[SPHERE.triangles]


def test_on_a_round_sphere_they_are_longitude_and_latitude():
    poles = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    found = meridians_and_parallels(S2(), CORNERS, CORNERS, poles)
    colatitude = np.arccos(np.clip(CORNERS[..., 2], -1, 1)) / np.pi
    assert np.abs(found[..., 1] - colatitude).max() < 0.015
    longitude = np.arctan2(CORNERS[..., 1], CORNERS[..., 0]) / (2 * np.pi)
    away = np.abs(CORNERS[..., 2]) < 1 - 1e-9
    for sign in (1, -1):
        shift = (found[..., 0] - sign * longitude)[away] % 1
        if np.ptp(np.minimum(np.abs(shift - shift[0]), 1 - np.abs(shift - shift[0]))) < 1e-12:
            return
    pytest.fail("meridians are no longitudes")


def test_no_triangle_has_a_leap():
    found = meridians_and_parallels(S2(), CORNERS, CORNERS, SPHERE.vertices[[0, 3]])
    width = np.ptp(found[..., 0], axis=1)
    assert width.max() <= 0.5
    assert (np.floor(found[..., 0].mean(axis=1)) == 0).all()


def test_parallels_of_a_long_surface_are_as_far_apart_as_in_space():
    """A prolate spheroid of axes 1, 1, 5 with the conformal coordinates of a sphere of revolution."""
    long = CORNERS * [1.0, 1.0, 5.0]
    # The isothermal latitude of the spheroid, by integrating ds / r along a meridian (trapezoidal rule).
    t = np.linspace(1e-4, np.pi - 1e-4, 200001)
    speed = np.hypot(np.cos(t), 5 * np.sin(t))
    height = np.concatenate([[0.0], np.cumsum((speed / np.sin(t))[1:] + (speed / np.sin(t))[:-1])]) * (t[1] - t[0]) / 2
    height -= height[len(t) // 2]
    angle = np.arccos(np.clip(CORNERS[..., 2], -1, 1))
    psi = np.interp(angle, t, height)
    ring = CORNERS[..., :2] / np.maximum(np.linalg.norm(CORNERS[..., :2], axis=-1, keepdims=True), 1e-300)
    at_pole = np.abs(CORNERS[..., 2]) > 1 - 1e-12
    x = np.concatenate([ring / np.cosh(psi)[..., None], -np.tanh(psi)[..., None]], axis=-1)
    x[at_pole] = np.concatenate([np.zeros((at_pole.sum(), 2)), np.sign(CORNERS[at_pole][:, 2:])], axis=1)
    found = meridians_and_parallels(S2(), x, long, np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]))
    length = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2)])
    truth = np.interp(angle, t, length / length[-1])
    assert np.abs(found[..., 1] - truth).max() < 0.02


def test_a_limb_does_not_take_all_of_the_square():
    """Along a finger the height hardly grows: parallels there are at most three times as far apart as in squares."""
    finger = CORNERS.copy()
    finger[..., 0] += 300 * np.maximum(CORNERS[..., 0] - 0.98, 0.0) / 0.02
    found = meridians_and_parallels(S2(), CORNERS, finger, np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]))[..., 1]
    away = np.abs(CORNERS[..., 2]) < 0.99
    height, parallel = -np.arctanh(CORNERS[..., 2][away]), found[away]
    order = np.argsort(height, kind="stable")
    at = np.linspace(height.min(), height.max(), 120)
    spacing = np.diff(np.interp(at, height[order], parallel[order])) / np.diff(at)
    assert spacing.min() > 0
    assert 2 * np.pi * spacing.max() < 3.1
