"""How much fairing data ask for: noise is what residuals have along normals."""

from __future__ import annotations

import numpy as np
import pytest
from orbiframe_fitters.cross_validation import Trial
from scipy.sparse import csr_array

LEAST = 1e-3


def trial(values: np.ndarray, normals: np.ndarray | None) -> Trial:
    """Values at 200 places of a circle, by 80 values of hats about it whose second differences are small."""
    count, size = 200, 80
    place = np.arange(count) * size / count
    left = np.floor(place).astype(int)
    share = place - left
    rows = csr_array(
        (np.concatenate([1 - share, share]), (np.tile(np.arange(count), 2), np.concatenate([left, (left + 1) % size]))),
        shape=(count, size),
    )
    bend = np.roll(np.eye(size), 1, axis=0) - 2 * np.eye(size) + np.roll(np.eye(size), -1, axis=0)
    return Trial(rows, np.ones(count), values, (rows.T @ rows).toarray(), bend.T @ bend, normals)


def smooth() -> np.ndarray:
    """A curve that goes up and down eight times about a circle, which fairness lessens."""
    turn = 2 * np.pi * np.arange(200) / 200
    return np.stack([np.cos(turn), np.sin(turn), 0.1 * np.sin(8 * turn)], axis=1)


NORMAL = np.tile([0.0, 0.0, 1.0], (200, 1))
WIGGLE = 0.05 * np.random.default_rng(3).normal(size=200)


@pytest.mark.parametrize("axis", [0, 1])
def test_what_lies_along_the_surface_is_no_noise(axis: int) -> None:
    values = smooth()
    values[:, axis] += WIGGLE
    assert trial(values, NORMAL).fairing(LEAST, None) == LEAST
    assert trial(values, None).fairing(LEAST, None) > 10 * LEAST


def test_what_lies_across_it_is() -> None:
    values = smooth()
    values[:, 2] += WIGGLE
    assert trial(values, NORMAL).fairing(LEAST, None) > 10 * LEAST


def test_a_stated_noise_is_that_of_the_heights() -> None:
    values = smooth()
    values[:, 2] += WIGGLE
    rough = trial(values, NORMAL).fairing(LEAST, 0.01)
    right = trial(values, NORMAL).fairing(LEAST, 0.05)
    assert rough == LEAST < right
