"""Short loops: laws, lengths that are known, and the best of all cuts at a base point."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from orbiframe_markers.tree_cotree import tree_cotree
from reference_meshes import connected_sum, dataset, grid, reference
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, dijkstra

from orbiframe import Polyhedron, TopologyError
from orbiframe.testing import Lab, contract_tests, laws_of

test_laws = contract_tests("marker", tree_cotree)
test_laws_of_one_base = contract_tests("marker", tree_cotree, params={"bases": 1})


@pytest.mark.parametrize("law", laws_of("marker").laws, ids=lambda law: law.__name__)
def test_every_law_rejects_its_mutant(law, tmp_path):
    with pytest.raises(AssertionError):
        law(laws_of("marker").mutants[law.__name__](tree_cotree), Lab(tmp_path))


def test_loops_of_a_torus_of_revolution_are_its_inner_circle_and_a_meridian():
    mesh = grid(40, 20)
    polygon = [n * 2 * r * np.sin(np.pi / n) for n, r in ((40, 1.0), (20, 1.0))]
    best = tree_cotree(mesh, bases=len(mesh.vertices))
    np.testing.assert_allclose(best.loop_length, sum(polygon), rtol=1e-12)
    assert tree_cotree(mesh).loop_length < 1.05 * sum(polygon)


@pytest.mark.parametrize("mesh", [reference("torus"), connected_sum("PP"), connected_sum("PPP")])
def test_loops_are_the_shortest_of_all_cuts_along_the_tree(mesh):
    """The edges left by every cotree beside the tree of shortest paths, over all of them, by brute force."""
    marking = tree_cotree(mesh, bases=1)
    base = int(marking.loops[0][0])
    edges = np.flatnonzero(mesh.representative)
    ends = mesh.tail[edges], mesh.head[edges]
    graph = coo_array((mesh.edge_lengths[edges], ends), shape=[len(mesh.vertices)] * 2).tocsr()
    far, parent = dijkstra(graph, directed=False, indices=base, return_predecessors=True)
    tree = (parent[ends[0]] == ends[1]) | (parent[ends[1]] == ends[0])
    free = edges[~tree]
    loop = far[mesh.tail[free]] + mesh.edge_lengths[free] + far[mesh.head[free]]
    sums = [
        loop[list(sides)].sum()
        for sides in combinations(range(len(free)), len(marking.loops))
        if _one_disc(mesh, np.delete(free, sides))
    ]
    np.testing.assert_allclose(marking.loop_length, min(sums), rtol=1e-12)


def _one_disc(mesh: Polyhedron, cotree: np.ndarray) -> bool:
    ends = mesh.face[cotree], mesh.face[mesh.twin[cotree]]
    graph = coo_array((np.ones(len(cotree)), ends), shape=[mesh.face_count] * 2).tocsr()
    return connected_components(graph, directed=False)[0] == 1


def test_more_base_points_give_no_longer_loops():
    mesh = dataset("plate_genus2")
    lengths = [tree_cotree(mesh, bases=count).loop_length for count in (1, 2, 8, 20)]
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[-1] < lengths[0]


def test_open_meshes_are_refused():
    with pytest.raises(TopologyError, match="closed polyhedron"):
        tree_cotree(Polyhedron.from_faces(np.eye(3), [[0, 1, 2]]))
