"""Clusters: points that coincide, exactly or within a tolerance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from orbiframe.errors import TopologyError

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_NEIGHBOURS = 100


def clusters(points: Floats, tolerance: float = 0.0) -> Ints:
    """The cluster of every point, (n,): points at a distance of at most the tolerance share one, and so do chains.

    Clusters are numbered by their first points. Tolerance 0 joins equal points only (0 and -0 are equal). Two clusters
    are farther apart than the tolerance; one cluster may be wider than it. Raises TopologyError where points have more
    than a hundred neighbours within the tolerance, on average.
    """
    label = _equal(points)
    if tolerance <= 0 or not len(points):
        return label
    first = first_of_each(label)
    return _by_first((_near(*unit_scale(points[first], tolerance)))[label])


def first_of_each(label: Ints) -> Ints:
    """The first member of every cluster, (k,)."""
    return np.unique(label, return_index=True)[1].astype(np.intp)


def unit_scale(points: Floats, length: float = 0.0) -> tuple[Floats, float]:
    """Points and a length times the power of two that makes the largest coordinate about 1, so that squares exist."""
    exponent = -int(np.frexp(np.abs(points).max(initial=0.0))[1])
    with np.errstate(over="ignore"):
        return np.ldexp(points, exponent), float(np.ldexp(length, exponent))


def _equal(points: Floats) -> Ints:
    order = np.lexsort(points.T)
    ordered = points[order]
    fresh = np.ones(len(points), dtype=np.bool_)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    label = np.empty(len(points), dtype=np.intp)
    label[order] = np.cumsum(fresh) - 1
    return _by_first(label)


def _near(points: Floats, tolerance: float) -> Ints:
    tree = cKDTree(points)
    most = _NEIGHBOURS * len(points)
    if len(points) > _NEIGHBOURS and tree.count_neighbors(tree, tolerance) > most:
        raise TopologyError(
            f"each of {len(points)} vertices has more than {_NEIGHBOURS} others within the tolerance, on average; "
            "take a smaller tolerance, below the length of the edges"
        )
    pairs = tree.query_pairs(tolerance, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points)))
    return connected_components(graph.tocsr(), directed=False)[1].astype(np.intp)


def _by_first(label: Ints) -> Ints:
    """The same clusters, numbered in the order of their first members."""
    first = first_of_each(label)
    rank = np.empty(len(first), dtype=np.intp)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[label]
