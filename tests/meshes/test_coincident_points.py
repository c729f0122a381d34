"""Clusters against brute force."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from orbiframe.errors import TopologyError
from orbiframe.meshes.coincident_points import clusters, first_of_each, unit_scale


def by_brute_force(points: np.ndarray, tolerance: float) -> list[int]:
    """Spread the smallest index along all pairs that are near, until nothing changes; number by first members."""
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    label = np.arange(len(points))
    for _ in points:
        label = np.array([label[distance[i] <= tolerance].min() for i in range(len(points))])
    return [sorted(set(label.tolist())).index(i) for i in label.tolist()]


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 25), st.sampled_from([0.0, 1.0, 1.5, 2.5]))
def test_clusters_are_chains_of_near_points(seed: int, count: int, tolerance: float) -> None:
    points = np.random.default_rng(seed).integers(0, 6, (count, 3)).astype(float)
    assert clusters(points, tolerance).tolist() == by_brute_force(points, tolerance)


def test_chains_are_one_cluster_and_its_first_member_leads() -> None:
    line = np.outer([3, 0, 1, 2, 9], [1.0, 0, 0])
    label = clusters(line, 1.0)
    assert label.tolist() == [0, 0, 0, 0, 1]
    assert first_of_each(label).tolist() == [0, 4]


def test_zeros_of_both_signs_are_equal_and_the_last_bit_counts() -> None:
    points = np.array([[0.0, 1, 2], [-0.0, 1, 2], [0, np.nextafter(1, 2), 2]])
    assert clusters(points).tolist() == [0, 0, 1]


@pytest.mark.parametrize("scale", [1e-300, 1e-150, 1e150, 1e300])
def test_clusters_do_not_depend_on_the_scale(scale: float) -> None:
    points = np.random.default_rng(3).random((50, 3))
    assert clusters(points * scale, 0.1 * scale).tolist() == clusters(points, 0.1).tolist()


def test_a_tolerance_that_swallows_the_mesh_is_refused_at_once() -> None:
    with pytest.raises(TopologyError, match="smaller tolerance"):
        clusters(np.random.default_rng(0).random((5000, 3)), 1.0)


def test_a_thousand_points_in_one_place_are_no_reason_to_refuse() -> None:
    assert clusters(np.zeros((1000, 3)), 1.0).max() == 0


def test_unit_scale_changes_no_digit() -> None:
    points, length = unit_scale(np.array([[3e200, 0, -1e190]]), 7e199)
    assert points.max() < 1 <= 2 * points.max()
    assert points[0, 0] / length == 3e200 / 7e199
