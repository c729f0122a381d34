"""Even bends: edges that bend much because a round shape has few of them, and not because they are sharp."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.meshes.bending import SHARP, bending
from orbiframe.meshes.polyhedron import Polyhedron

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_FLAT = np.radians(3)
# Eight edges about a tube bend by 45 degrees.
_MOST = np.radians(50)
# Flats of an even width: the wider one is at most so many times as wide.
_UNEVEN = 1.5


def even_share(mesh: Polyhedron) -> float:
    """How much of the bending of a triangle mesh lies in sharp edges that no round shape of even facets has.

    An edge is sharp from 40 degrees on; up to 50 degrees it may be one of few about a round shape, if the flats on both
    sides of it are about as wide, as far as they reach from it. A chamfer beside a side of a box is much narrower.
    """
    angle = bending(mesh).angle
    amount = mesh.edge_lengths * angle
    sharp = angle > SHARP
    doubtful = np.flatnonzero(sharp & (angle <= _MOST))
    if amount.sum() <= 0:
        return 0.0
    here, there = widths(mesh, angle, doubtful), widths(mesh, angle, mesh.twin[doubtful])
    even = np.maximum(here, there) <= _UNEVEN * np.minimum(here, there)
    return float((amount[sharp].sum() - amount[doubtful[even]].sum()) / amount.sum())


def widths(mesh: Polyhedron, angle: Floats, edges: Ints) -> Floats:
    """How far the flat at each of some halfedges reaches from its line; a flat is joined by edges that hardly bend.

    It reaches farthest at its rim, so faces inside of it are not looked at.
    """
    flat = angle < _FLAT
    links = coo_array(
        (np.ones(int(flat.sum())), (mesh.face[flat], mesh.face[mesh.twin[flat]])), shape=(mesh.face_count,) * 2
    )
    region = connected_components(links, directed=False)[1]
    rim = np.unique(mesh.face[~flat])
    order = rim[np.argsort(region[rim], kind="stable")]
    first = np.searchsorted(region[order], np.arange(region.max() + 2))
    return np.array(
        [_reach(mesh, h, order[first[r] : first[r + 1]]) for h, r in zip(edges, region[mesh.face[edges]], strict=True)]
    )


def _reach(mesh: Polyhedron, edge: int, faces: Ints) -> float:
    """The largest distance of corners of faces from the line of a halfedge."""
    start = mesh.vertices[mesh.tail[edge]]
    along = mesh.vertices[mesh.head[edge]] - start
    along = along / np.linalg.norm(along)
    offset = mesh.vertices[mesh.triangles[faces].ravel()] - start
    return float(np.linalg.norm(offset - np.outer(offset @ along, along), axis=1).max())
