"""Location: in which geodesic triangle a point of X/H lies, found by walking from a table of starts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from orbiframe.errors import FitError
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation
from orbiframe.triangulations.walks import fill_grid, order_by_square, refill, walk_all

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_SQUARES_PER_TRIANGLE = 2.0
_LEAST_SQUARES_ASIDE, _MOST_SQUARES_ASIDE = 4, 512
_MANY = 20_000  # from so many points on it pays to sort them by squares
# Isometries that are as near as this, of their largest entry, are one but for rounding: no two of a group are.
_SAME_LIFT = 1e-3
# Numbers in a patch of this radius are so large that products of many isometries lose digits.
_LARGE = 2.0


class Location(NamedTuple):
    """Where points lie, in an order in which neighbours stand together, so that their triangles stay in the cache.

    order: (n,), the numbers of the points; face: (n,), the triangle of point order[k]; columns: (n, 3, 1), the point in
    the frame of the triangle, or (n, 3, 3), the point and its `geometry.frame`.
    """

    order: Ints
    face: Ints
    columns: Floats


@dataclass(frozen=True, eq=False)
class Locator:
    """Finds the triangles of points of X/H: a grid on every patch gives the start, and gluings carry the point on.

    Whoever walks across an edge moves the point into the next frame, so a point far from its patch is reduced on the
    way: no fundamental domain and no group element is needed.
    """

    domain: GeodesicTriangulation

    def locate(self, points: Points, *, frames: bool = False) -> Location:
        """The triangles of points, with the points in the frames of their triangles, on request with their frames.

        Raises FitError for a point that is not finite.
        """
        x = np.asarray(points.x, dtype=np.float64)
        patch, order = np.asarray(points.patch, dtype=np.intp), np.arange(len(x))
        if len(x) >= _MANY:
            order_by_square(patch, x, self.grid.half_width, self.grid.face.shape, order)
            x, patch = x[order], patch[order]
        columns = np.array(self.domain.geometry.carry(x) if frames else x[:, :, None], order="C")
        face = np.empty(len(x), dtype=np.intp)
        require_found(walk_all(patch, face, columns, self.steps, self.grid), Points(patch, x), order)
        return Location(order, face, columns)

    @cached_property
    def steps(self) -> tuple[Floats, Ints, Floats, int]:
        """What a walk needs: inverses of corner matrices (F, 3, 3), twins (3 F,), isometries across edges, and K."""
        geometry = self.domain.geometry
        inverse = np.linalg.inv(np.swapaxes(self.domain.corners, 1, 2))
        across = self.domain.gluing[self.domain.twin]
        return np.ascontiguousarray(inverse), self.domain.twin, np.ascontiguousarray(across), geometry.curvature

    @cached_property
    def grid(self) -> Grid:
        """Where walks start."""
        atlas, geometry = self.domain.orbifold.atlas, self.domain.geometry
        share = self.domain.face_count / atlas.patch_count
        squares = int(np.clip(np.sqrt(_SQUARES_PER_TRIANGLE * share), _LEAST_SQUARES_ASIDE, _MOST_SQUARES_ASIDE))
        face, isometry = self._seeds()
        far = geometry.from_polar(atlas.radius, 0.0)
        half_width = far[:, 1] / (1 + np.abs(far[:, 0])) if geometry.curvature <= 0 else np.ones(atlas.patch_count)
        sides = 2 if geometry.curvature > 0 else 1
        grid = Grid(
            np.empty((atlas.patch_count, sides, squares, squares), dtype=np.intp),
            np.empty((atlas.patch_count, sides, squares, squares, 3, 3)),
            half_width,
        )
        fill_grid(face, isometry, self.steps, grid.face, grid.isometry, half_width)
        self._replace_by_placements(grid)
        return grid

    def _replace_by_placements(self, grid: Grid) -> None:
        """Where a walk has come to the lift of a triangle that lies in the patch, its placement is the way, exactly.

        In large patches the other squares are reached again, from the nearest of those.
        """
        exact = self.domain.geometry.inverse(self.domain.placement)[grid.face]
        here = np.arange(len(grid.face))[:, None, None, None] == self.domain.patch[grid.face]
        size = np.abs(exact).max(axis=(-2, -1))
        here &= np.abs(grid.isometry - exact).max(axis=(-2, -1)) < _SAME_LIFT * size
        grid.isometry[here] = exact[here]
        for p in np.flatnonzero(self.domain.orbifold.atlas.radius > _LARGE if grid.face.shape[1] == 1 else []):
            if here[p, 0].any() and not here[p, 0].all():
                source = distance_transform_edt(~here[p, 0], return_distances=False, return_indices=True)
                refill(
                    np.asarray(source), here[p, 0], self.steps, grid.face[p, 0], grid.isometry[p, 0], grid.half_width[p]
                )

    def _seeds(self) -> tuple[Ints, Floats]:
        """A triangle for every patch and the isometry from the frame of the patch to the frame of the triangle."""
        atlas, geometry = self.domain.orbifold.atlas, self.domain.geometry
        face = np.full(atlas.patch_count, -1, dtype=np.intp)
        isometry = np.tile(np.eye(3), (atlas.patch_count, 1, 1))
        own, first = np.unique(self.domain.patch, return_index=True)
        face[own], isometry[own] = first, geometry.inverse(self.domain.placement[first])
        while (face < 0).any():
            new = np.flatnonzero((face[atlas.tail] < 0) & (face[atlas.head] >= 0) & (atlas.tail >= 0))
            patch, first = np.unique(atlas.tail[new], return_index=True)
            step = new[first]
            back = atlas.isometry[atlas.inverse[step]]
            face[patch] = face[atlas.head[step]]
            isometry[patch] = isometry[atlas.head[step]] @ back
        return face, isometry


class Grid(NamedTuple):
    """Starts of walks: triangles (P, sides, n, n) and isometries (P, sides, n, n, 3, 3) from patch to triangle.

    The squares divide the square of the given half width (P,) in the chart (x1, x2) / (1 + |x0|); sides: x0 > 0 and <
    0.
    """

    face: Ints
    isometry: Floats
    half_width: Floats


def require_found(failed: int, points: Points, order: Ints | None = None) -> None:
    """Raise FitError for the point that a walk has found no triangle for, if there is one (failed >= 0).

    order: the numbers of the points, if they are not their places.
    """
    if failed >= 0:
        number = failed if order is None else order[failed]
        raise FitError(
            f"point {number} (patch {points.patch[failed]}, x = {points.x[failed]}) lies in no triangle of X/H; "
            "give finite points of X, in the frame of a patch"
        )
