"""Fine marks: what is known of the facets of a refined mesh, at its own edges and vertices."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.bisection import Bisection

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

# Barycentric coordinates below this are those of points of an edge.
_ON_EDGE = 1e-9


def fine_marks(refinement: Bisection, marked: Bools) -> Bools:
    """The halfedges of the refined mesh that lie on marked halfedges (H,) of the facets, (G,)."""
    count = refinement.facets.face_count
    own = np.concatenate([np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3, 1))], axis=2)
    own[:, :, 3] = np.arange(count)[:, None]
    fine = refinement.spread(own)
    facet = fine[:, 0, 3].round().astype(np.intp)
    near = fine[:, :, :3] < _ON_EDGE
    # The edge opposite corner k is halfedge k + 1, and a fine edge lies on it if both its ends do.
    on_edge = np.roll(near & np.roll(near, -1, axis=1), 1, axis=2)
    found = (on_edge & marked.reshape(-1, 3)[facet][:, None]).any(axis=2).ravel()
    return np.asarray(found | found[refinement.polyhedron.twin])


def fine_largest(refinement: Bisection, of_facet: Floats) -> Floats:
    """The largest of a quantity of the facets (F,) about every vertex of the refined mesh, (V,)."""
    fine = refinement.spread(np.repeat(of_facet, 3).reshape(-1, 3, 1))[:, 0, 0]
    found = np.zeros(len(refinement.polyhedron.vertices))
    np.maximum.at(found, refinement.polyhedron.tail, np.repeat(fine, 3))
    return found
