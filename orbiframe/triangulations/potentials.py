"""Potentials: numbers at nodes of a graph from their differences along its edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

Ints = NDArray[np.intp]


def potentials(roots: NDArray[np.bool_], tail: Ints, head: Ints, difference: Ints) -> Ints:
    """The numbers x (count, k) with x[tail] = x[head] + difference along a tree, and 0 at the roots.

    roots: (count,) bool, one node of every component; tail, head: (m,), the edges; difference: (m, k), consistent round
    every circle, so that any tree gives the same numbers.
    """
    count, start = len(roots), np.flatnonzero(roots)
    ends = np.concatenate([tail, np.full(len(start), count)]), np.concatenate([head, start])
    step = np.concatenate([difference, np.zeros((len(start), difference.shape[1]), dtype=np.intp)])
    both = np.concatenate(ends), np.concatenate(ends[::-1])
    # Of several edges between two nodes the first one is taken.
    number = np.unique(np.stack(both), axis=1, return_index=True)[1]
    signed = np.concatenate([step, -step])
    tails, heads = both[0][number], both[1][number]
    graph = coo_array((np.ones(len(number)), (tails, heads)), shape=(count + 1, count + 1)).tocsr()
    parent = breadth_first_order(graph, count)[1].astype(np.intp)
    parent[count] = count
    key, wanted = tails * (count + 1) + heads, np.arange(count) * (count + 1) + parent[:count]
    value = np.zeros((count + 1, difference.shape[1]), dtype=np.intp)
    value[:count] = signed[number[np.searchsorted(key, wanted)]]
    while (parent != count).any():
        value, parent = value + value[parent], parent[parent]
    return value[:count]
