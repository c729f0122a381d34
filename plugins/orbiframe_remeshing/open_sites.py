"""Open sites: vertices on a surface with a boundary, those on the boundary first, and triangles between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from orbiframe import OrbifoldSurface, Points
from orbiframe.surfaces import open_triangulation
from orbiframe_remeshing.surface_mesh import Rim, SurfaceMesh


def open_mesh(surface: OrbifoldSurface, count: int, seed: int = 0) -> SurfaceMesh:
    """Triangles on a surface with a boundary, with about `count` vertices that lie about evenly in space.

    Those on the boundary stay. Raises FitError where pieces of the boundary do not become edges.
    """
    found = open_triangulation(surface, count, seed)
    triangles, sites = found.triangles, found.sites
    used = np.zeros(len(found.vertex), dtype=np.bool_)
    used[triangles] = True
    number = np.cumsum(used) - 1
    mesh = SurfaceMesh.at(surface, Points(sites.patch[used], sites.x[used]), number[triangles])
    ends = number[found.pieces.geodesics().ends]
    return replace(mesh, creases=ends, rim=Rim(ends, found.pieces.along))
