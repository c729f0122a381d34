"""Beyond: the part of a map that only closes a mesh with a boundary, where few functions are wanted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.edge_paths import dijkstra_forest, edge_graph
from orbiframe.meshes.sizes import vector_areas
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]

# Beyond the boundary functions are as dense as on the mesh over this share of the root of its area; then fewer and
# fewer, down to a least share of the density on the mesh. At the boundary, where nothing holds them on the other side,
# they are denser by so much, over as far either way.
_WIDTH, _LEAST, _MORE = 0.05, 0.25, 1.5


def density_beyond(triangulation: Triangulation, *, doubled: bool = False) -> Floats:
    """How many functions per length there should be at the vertices of a mesh with a boundary, (V,): 1 far within.

    doubled: a second copy of the mesh lies beyond, so that functions lie alike on both sides of the boundary.
    """
    mesh, border = triangulation.polyhedron, triangulation.border
    area = np.linalg.norm(vector_areas(mesh), axis=1)[triangulation.own_faces].sum()
    away = dijkstra_forest(edge_graph(mesh, mesh.edge_lengths), np.unique(mesh.tail[border])).distance
    width = _WIDTH * float(np.sqrt(area))
    near = 1 + (0.0 if doubled else _MORE - 1) * np.exp(-((away / width) ** 2))
    away[np.unique(mesh.triangles[triangulation.own_faces])] = 0
    return np.asarray(near * np.maximum(1 / (1 + np.maximum(away / width - 1, 0)), _LEAST))
