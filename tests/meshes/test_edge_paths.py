"""Shortest paths and farthest points against scipy and against the definition."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra, minimum_spanning_tree

from orbiframe.meshes.edge_paths import (
    Graph,
    covering_points,
    dijkstra_forest,
    edge_graph,
    farthest_points,
    first_largest,
    joining_edges,
)
from orbiframe.meshes.polyhedron import Polyhedron


def bumpy_torus(n: int, m: int) -> Polyhedron:
    """An n by m grid of triangles on a torus, with irregular vertices."""
    i, j = np.divmod(np.arange(n * m), m)
    noise = np.random.default_rng(5).normal(scale=0.03, size=(n * m, 3))
    u, v = 2 * np.pi * i / n, 2 * np.pi * j / m
    vertices = np.stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)], axis=1) + noise
    a, b = i * m + j, (i + 1) % n * m + j
    c, d = (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
    return Polyhedron.from_faces(vertices, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))


@pytest.fixture(scope="module")
def torus() -> Polyhedron:
    return bumpy_torus(24, 11)


@pytest.fixture(scope="module")
def graph(torus: Polyhedron) -> Graph:
    return edge_graph(torus)


def all_distances(graph: Graph) -> np.ndarray:
    return dijkstra(csr_array((graph.length, graph.neighbour, graph.start)))


def test_every_edge_is_two_links_along_its_halfedge(torus: Polyhedron, graph: Graph) -> None:
    origin = np.repeat(np.arange(len(torus.vertices)), np.diff(graph.start))
    tail = np.where(graph.backward, torus.head[graph.halfedge], torus.tail[graph.halfedge])
    head = np.where(graph.backward, torus.tail[graph.halfedge], torus.head[graph.halfedge])
    np.testing.assert_array_equal(tail, origin)
    np.testing.assert_array_equal(head, graph.neighbour)
    np.testing.assert_array_equal(np.bincount(torus.edge[graph.halfedge]), 2)


def test_forest_agrees_with_scipy(graph: Graph) -> None:
    sources = [100, 3, 57]
    forest = dijkstra_forest(graph, sources)
    table = all_distances(graph)[sources]
    np.testing.assert_allclose(forest.distance, table.min(axis=0), atol=1e-14)
    np.testing.assert_array_equal(forest.owner, table.argmin(axis=0))


def test_paths_of_the_forest_add_up_and_parents_come_first(graph: Graph) -> None:
    forest = dijkstra_forest(graph, [0, 200])
    child = np.flatnonzero(forest.link >= 0)
    assert len(child) == len(forest.link) - 2
    np.testing.assert_array_equal(graph.neighbour[forest.link[child]], child)
    np.testing.assert_array_equal(
        forest.distance[child], forest.distance[forest.parent[child]] + graph.length[forest.link[child]]
    )
    position = np.argsort(forest.order)
    assert (position[forest.parent[child]] < position[child]).all()


def test_unreached_vertices_are_said_to_be_so() -> None:
    two = Polyhedron.from_faces(np.random.default_rng(0).normal(size=(8, 3)), [[0, 1, 2, 3], [4, 5, 6, 7]])
    forest = dijkstra_forest(edge_graph(two), [1])
    np.testing.assert_array_equal(np.isinf(forest.distance), [False] * 4 + [True] * 4)
    np.testing.assert_array_equal(forest.owner, [0] * 4 + [-1] * 4)
    assert sorted(forest.order) == [0, 1, 2, 3]


def test_each_next_point_is_the_farthest_from_all_before_it(graph: Graph) -> None:
    table = all_distances(graph)
    spacing = farthest_points(graph, 40, first=7)
    assert spacing.chosen[0] == 7
    for k in range(1, 40):
        assert spacing.chosen[k] == table[spacing.chosen[:k]].min(axis=0).round(12).argmax()
    np.testing.assert_allclose(spacing.distance, table[spacing.chosen].min(axis=0), atol=1e-13)
    own = table[spacing.chosen[spacing.owner], np.arange(len(table))]
    np.testing.assert_allclose(spacing.distance, own, atol=1e-13)


def test_a_radius_stops_the_choice_as_soon_as_it_covers(graph: Graph) -> None:
    spacing = farthest_points(graph, 10**6, radius=0.7)
    assert spacing.distance.max() < 0.7
    assert all_distances(graph)[spacing.chosen[:-1]].min(axis=0).max() >= 0.7


def ring_of_grid(noise: float, seed: int) -> Graph:
    """A regular torus in the plane of its indices, whose equal lengths differ by a little noise."""
    torus = bumpy_torus(12, 8)
    graph = edge_graph(torus, np.ones(len(torus.tail)))
    edge = np.minimum(graph.halfedge, torus.twin[graph.halfedge])
    factor = 1 + noise * np.random.default_rng(seed).uniform(-1, 1, len(torus.tail))
    return graph._replace(length=graph.length * factor[edge])


@pytest.mark.parametrize("noise", [1e-15, 1e-12])
def test_among_equals_rounding_decides_nothing(noise: float) -> None:
    """All edges are as long as each other, so nearly every choice is one among many equals."""
    plain = ring_of_grid(0.0, 0)
    for seed in range(20):
        noisy = ring_of_grid(noise, seed)
        for count, radius in ((7, 0.0), (30, 0.0), (96, 2.0)):
            expected, found = (farthest_points(graph, count, first=5, radius=radius) for graph in (plain, noisy))
            np.testing.assert_array_equal(found.chosen, expected.chosen)
            np.testing.assert_array_equal(found.owner, expected.owner)
        np.testing.assert_array_equal(covering_points(noisy, 2.0), covering_points(plain, 2.0))
        expected, found = (dijkstra_forest(graph, [90, 3, 40]) for graph in (plain, noisy))
        np.testing.assert_array_equal(found.owner, expected.owner)
        np.testing.assert_array_equal(found.link, expected.link)


def test_every_farthest_point_is_as_far_as_any_and_the_lowest_not_yet_tried() -> None:
    graph = ring_of_grid(0.0, 0)
    table, chosen = all_distances(graph), farthest_points(graph, 96, first=5).chosen
    assert len(np.unique(chosen)) == 96
    for k in range(1, 96):
        gap = table[chosen[:k]].min(axis=0)
        assert gap[chosen[k]] == gap.max()
    assert chosen[1] == table[5].argmax()


def test_sources_at_no_distance_from_each_other_stay_sources() -> None:
    flat = Polyhedron.from_faces([[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    forest = dijkstra_forest(edge_graph(flat), [2, 1])
    np.testing.assert_array_equal(forest.link[[1, 2]], -1)
    np.testing.assert_array_equal(forest.owner[[1, 2]], [1, 0])


def test_the_first_of_the_largest() -> None:
    assert first_largest(np.array([0.1 + 0.2 - 1e-15, 0.0, 0.3, 0.1 + 0.2])) == 0
    assert first_largest(np.array([0.3 - 1e-6, 0.3])) == 1
    assert first_largest(np.zeros(3)) == 0


@pytest.mark.parametrize("radius", [0.2, 0.7, 100.0])
def test_covering_points_are_apart_and_cover(graph: Graph, radius: float) -> None:
    table, chosen = all_distances(graph), covering_points(graph, radius)
    assert table[chosen].min(axis=0).max() < radius
    assert (table[np.ix_(chosen, chosen)] + 1e6 * np.eye(len(chosen))).min() >= radius * (1 - 1e-14)
    # The first one, and each next one as soon as it is too far from all before it: nothing else is left out.
    for k in range(len(chosen)):
        skipped = np.arange(chosen[k - 1] + 1 if k else 0, chosen[k])
        assert (table[np.ix_(chosen[:k], skipped)].min(axis=0, initial=np.inf) < radius).all()


def test_covering_points_of_every_component() -> None:
    two = Polyhedron.from_faces(np.random.default_rng(0).normal(size=(6, 3)), [[0, 1, 2], [3, 4, 5]])
    np.testing.assert_array_equal(covering_points(edge_graph(two), 1e3), [0, 3])


def test_every_vertex_once_and_no_more(graph: Graph) -> None:
    spacing = farthest_points(graph, 10**6)
    np.testing.assert_array_equal(np.sort(spacing.chosen), np.arange(24 * 11))


def test_coincident_vertices_are_chosen_once() -> None:
    flat = Polyhedron.from_faces([[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    assert len(farthest_points(edge_graph(flat), 4).chosen) == 3


@pytest.mark.parametrize("edges", [0, 30, 300])
def test_joining_edges_of_a_sorted_list_are_the_shortest_forest(edges: int) -> None:
    rng = np.random.default_rng(edges)
    tail, head = rng.integers(60, size=(2, edges))
    length = np.sort(rng.uniform(1, 2, edges))
    joins = joining_edges(60, tail, head)
    table = np.full((60, 60), np.inf)
    np.minimum.at(table, (tail, head), length)
    np.minimum.at(table, (head, tail), length)
    table[np.isinf(table) | np.eye(60, dtype=bool)] = 0.0
    assert length[joins].sum() == pytest.approx(minimum_spanning_tree(table).sum())
    assert 60 - joins.sum() == connected_components(table, directed=False)[0]
