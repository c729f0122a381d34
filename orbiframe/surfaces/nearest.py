"""Nearest: the points of a surface that are nearest to given ones in space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.errors import FitError
from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.functions.feet import foot_points
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.border import inside, nearest_on_border
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]


def nearest_points(surface: OrbifoldSurface, targets: Floats, steps: int = 8) -> tuple[Points, Floats]:
    """The points of X/H whose surface points are nearest to targets (n, 3), and their distances (n,).

    The search begins over the nearest point of the triangles whose corners are the surface points over the vertices of
    the triangulation, and goes on by Newton's method: near the surface it finds the foot of the perpendicular to
    rounding. Where that lies beyond the boundary of a surface, the nearest point of the boundary is meant. Raises
    FitError for a basis without derivatives, and for targets that are not finite.
    """
    targets = np.asarray(targets, dtype=np.float64).reshape(-1, 3)
    bad = np.flatnonzero(~np.isfinite(targets).all(axis=1))
    if len(bad):
        raise FitError(f"point {bad[0]} is {targets[bad[0]].tolist()}; it must be finite: check the data")
    if not isinstance(surface.basis, DifferentiableBasis):
        raise FitError("this basis knows no derivatives, which the search needs; use one that does, such as 'ps6'")
    wanted = (targets - surface.origin) / surface.scale
    triangulation = surface.triangulation
    there = surface.basis.values(surface.vertex_points, surface.coefficients)
    corners = triangulation.polyhedron.triangles[triangulation.own_faces]
    face, barycentric = NearestPoints(Polyhedron.from_faces(there, corners)).places(wanted)
    start = triangulation.locate(triangulation.own_faces[face], barycentric)
    longest = float(np.linalg.norm(np.ptp(there[corners.ravel()], axis=0))) / 10
    feet, distance = foot_points(surface.basis, surface.coefficients, start, wanted, longest, steps)
    outside = np.flatnonzero(~inside(surface, feet))
    if len(outside):
        ends, away = nearest_on_border(surface, wanted[outside])
        feet.patch[outside], feet.x[outside], distance[outside] = ends.patch, ends.x, away
    return feet, distance * surface.scale
