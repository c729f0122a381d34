"""Edge curves: the images of the edges of the input on a smooth surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.face_diagonals import outline
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]


def edge_curves(surface: OrbifoldSurface, polyhedron: Polyhedron | None = None, *, steps: int = 8) -> Floats:
    """The images of the edges of a polyhedron on its surface as chains of points, (E, steps + 1, 3).

    polyhedron: whose triangles are `surface.refinement.coarse`; without it the edges of these triangles,
    of a mesh with a boundary those of its own.
    """
    coarse = surface.refinement.coarse
    own = surface.own[coarse.face]
    halfedges = np.flatnonzero(own & (coarse.representative | ~own[coarse.twin]))
    if polyhedron is not None:
        halfedges = outline(polyhedron)[polyhedron.representative]
    face, corner = np.divmod(np.repeat(halfedges, steps + 1), 3)
    share = np.tile(np.linspace(0, 1, steps + 1), len(halfedges))
    barycentric = np.zeros((len(face), 3))
    rows = np.arange(len(face))
    barycentric[rows, corner] = 1 - share
    barycentric[rows, (corner + 1) % 3] = share
    return surface.evaluate(surface.points(face, barycentric)).reshape(len(halfedges), steps + 1, 3)
