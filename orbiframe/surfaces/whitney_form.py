"""Edge form: a 1-form from its integrals along the edges of a mesh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.errors import FitError
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.point_location import Locator

Floats = NDArray[np.float64]


def edge_form(surface: OrbifoldSurface, integrals: ArrayLike) -> Callable[[Points], Floats]:
    """The 1-form with given integrals along the edges of the mesh that the map is of, linear in between.

    integrals: (H,), along the halfedges of `surface.triangulation.polyhedron`, those of twins being opposite, or equal
    where they run the same way. Returns what takes n points to the components along the frames of X, (n, 2): the sum
    over edges of w_ij (b_i db_j - b_j db_i) in barycentric coordinates b (Whitney, 1957). Raises FitError for integrals
    of another shape, and for those of twins that contradict each other.
    """
    mesh = surface.triangulation.polyhedron
    values = np.asarray(integrals, dtype=np.float64)
    if values.shape != mesh.tail.shape or not np.isfinite(values).all():
        raise FitError(
            f"the integrals have the shape {values.shape}; {len(mesh.tail)} finite numbers are needed, one for each "
            "halfedge of surface.triangulation.polyhedron"
        )
    other = values[mesh.twin]
    wrong = np.flatnonzero(np.abs(other + np.where(mesh.same, -1, 1) * values) > 1e-9 * np.abs(values).max())
    if len(wrong):
        raise FitError(
            f"halfedge {wrong[0]} has the integral {values[wrong[0]]:.6g} and its twin {other[wrong[0]]:.6g}; "
            "along one edge they must be opposite"
        )
    domain = GeodesicTriangulation.of_map(surface.triangulation)
    inverse, locator = np.linalg.inv(np.swapaxes(domain.corners, 1, 2)), Locator(domain)

    def components(points: Points) -> Floats:
        location = locator.locate(points, frames=True)
        place = inverse[location.face] @ location.columns
        b, slope, w = place[:, :, 0], place[:, :, 1:], values.reshape(-1, 3)[location.face]
        after = (1, 2, 0)
        terms = b[:, :, None] * slope[:, after] - b[:, after, None] * slope
        found = np.empty((len(b), 2))
        found[location.order] = np.einsum("nc,nck->nk", w, terms) / b.sum(axis=1)[:, None] ** 2
        return found

    return components
