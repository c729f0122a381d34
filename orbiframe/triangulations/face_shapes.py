"""Face shapes: how far the faces of a polyhedron are from regular polygons once they are mapped to X/H."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.face_diagonals import outline
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.planes.geometry import Geometry
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_ALIKE = 1e-9


@dataclass(frozen=True, eq=False)
class FaceShapes:
    """The shape of every face (F,) as a polygon of geodesics between the images of its corners in X.

    angle: radians, the largest deviation of an interior angle from that of the regular polygon of the same area, which
    is the mean of the interior angles; adjacent and opposite: the largest ratio of two adjacent sides, and of two
    opposite ones (nan where the number of corners is odd); area: signed as the areas of the triangulation; corners:
    the number of corners.
    """

    corners: Ints
    angle: Floats
    adjacent: Floats
    opposite: Floats
    area: Floats

    @property
    def size(self) -> Floats:
        """The ratio of the area to the mean area, or its reciprocal, whichever is larger; inf for no area."""
        with np.errstate(all="ignore"):
            share = self.area / self.area.mean()
            return np.where(share > 0, np.maximum(share, 1 / share), np.inf)

    def first(self, count: int) -> FaceShapes:
        """Those of the first faces."""
        few = slice(count)
        return FaceShapes(self.corners[few], self.angle[few], self.adjacent[few], self.opposite[few], self.area[few])

    def summary(self) -> dict[str, Any]:
        """Median, 95th percentile, maximum and the worst face of each measure; angles in degrees, None for no face."""
        measures = {
            "angle": np.degrees(self.angle),
            "adjacent": self.adjacent,
            "opposite": self.opposite,
            "size": self.size,
        }
        counts = {"count": len(self.corners), "corners": int(self.corners.max())}
        return counts | {name: _summary(values) for name, values in measures.items()}


def face_shapes(polyhedron: Polyhedron, refinement: Bisection, triangulation: Triangulation) -> FaceShapes:
    """The shapes of the faces of a polyhedron in X.

    refinement: of `triangulated(polyhedron)`; triangulation: the map of the refined mesh. Each face is lifted to X
    corner by corner along its edges, so that the refinement between its corners does not matter.
    """
    orbifold = triangulation.orbifold
    steps = refinement.composed(orbifold.atlas.isometry[triangulation.transition])[outline(polyhedron)]
    points = triangulation.points[polyhedron.tail]
    measured = np.empty((4, polyhedron.face_count))
    for size in np.unique(polyhedron.face_sizes):
        faces = np.flatnonzero(polyhedron.face_sizes == size)
        corners = polyhedron.offsets[faces][:, None] + np.arange(size)
        lifted = _lifted(points[corners], steps[corners])
        measured[:, faces] = _measured(orbifold.geometry, lifted)
    sign = _signs(refinement, triangulation, polyhedron)
    return FaceShapes(polyhedron.face_sizes, measured[0], measured[1], measured[2], sign * measured[3])


def _lifted(points: Floats, steps: Floats) -> Floats:
    """The corners of faces (F, n, 3) in the frame of the first one; steps (F, n, 3, 3) along the sides."""
    lifted = points.copy()
    frame = np.broadcast_to(np.eye(3), steps[:, 0].shape)
    for k in range(1, points.shape[1]):
        frame = frame @ steps[:, k - 1]
        lifted[:, k] = np.einsum("fij,fj->fi", frame, points[:, k])
    return lifted


def _measured(geometry: Geometry, corners: Floats) -> Floats:
    """Angle, adjacent, opposite and signed area of polygons (F, n, 3), as rows (4, F)."""
    n = corners.shape[1]
    after, before = np.roll(corners, -1, axis=1), np.roll(corners, 1, axis=1)
    area = geometry.triangle_area(corners[:, :1], corners[:, 1:-1], corners[:, 2:]).sum(axis=1)
    turn = np.where(area < 0, -1.0, 1.0)[:, None]
    angles = turn * geometry.angle(corners, after, before) % (2 * np.pi)
    sides = geometry.distance(corners, after)
    angle = np.abs(angles - angles.mean(axis=1, keepdims=True)).max(axis=1)
    adjacent = _largest_ratio(sides, np.roll(sides, -1, axis=1))
    opposite = _largest_ratio(sides, np.roll(sides, -(n // 2), axis=1)) if n % 2 == 0 else np.full(len(sides), np.nan)
    return np.stack([angle, adjacent, opposite, area])


def _largest_ratio(a: Floats, b: Floats) -> Floats:
    with np.errstate(all="ignore"):
        ratio = np.maximum(a, b) / np.minimum(a, b)
    return np.asarray(np.where(np.isfinite(ratio), ratio, np.inf).max(axis=1))


def _signs(refinement: Bisection, triangulation: Triangulation, polyhedron: Polyhedron) -> Floats:
    """The orientation of every face in the frame of its first corner, (F,): see `Triangulation.face_signs`."""
    corner = outline(polyhedron)[polyhedron.offsets[:-1]]
    place = np.zeros((len(corner), 3))
    place[np.arange(len(corner)), corner % 3] = 1.0
    fine, weights = refinement.locate(corner // 3, place)
    # The face's first corner is some corner of the fine triangle: its frame may be turned over against the first's.
    isometry = triangulation.orbifold.atlas.isometry
    steps = isometry[triangulation.transition].reshape(-1, 3, 3, 3)[fine]
    parity = np.ones((len(corner), 3))
    parity[:, 1] = triangulation.orbifold.geometry.parity(steps[:, 0])
    parity[:, 2] = triangulation.orbifold.geometry.parity(steps[:, 2])
    return np.asarray(triangulation.face_signs[fine] * parity[np.arange(len(corner)), weights.argmax(axis=1)])


def _summary(values: Floats) -> dict[str, Any]:
    known = np.flatnonzero(~np.isnan(values))
    if len(known) == 0:
        return {"median": None, "p95": None, "max": None, "worst_face": None}
    median, p95 = np.quantile(values[known], [0.5, 0.95], method="lower")
    top = float(values[known].max())
    # The first of those that are equal but for rounding, so that no processor names another face.
    near = values >= top - _ALIKE * max(1.0, abs(top)) if np.isfinite(top) else values == top
    return {"median": float(median), "p95": float(p95), "max": top, "worst_face": int(np.flatnonzero(near)[0])}
