"""Circle packing: radii at the vertices for which all angle sums are 2 pi, hence a metric of constant curvature."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array

from orbiframe import MapError, Polyhedron
from orbiframe_parametrizers.elimination import elimination_order, factorised

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_TOLERANCE = 1e-11
_STEPS = 100


@dataclass(frozen=True, eq=False)
class Packing:
    """Radii (V,) of a circle packing, its edge lengths (H,) r_i + r_j, corner angles (H,), and the Newton steps."""

    radii: Floats
    lengths: Floats
    angles: Floats
    steps: int


def packed(mesh: Polyhedron, curvature: int, *, without_face: int | None = None) -> Packing:
    """The tangential circle packing of a closed triangulation in the hyperbolic (-1) or Euclidean (0) plane.

    without_face: pack a sphere without that face in the Euclidean plane, its three corners having radius 1.

    Unknown u = ln tanh(r/2) (ln r in the plane), Newton on the convex energy whose gradient is 2 pi minus the angle
    sum; its Hessian is symmetric with positive off-diagonal weights. It exists and is unique (up to scale in the
    plane) for every triangulation of a closed surface with chi < 0 (chi = 0), orientable or not: Koebe, Andreev,
    Thurston; Bobenko and Springborn 2004. Raises MapError if 100 steps do not reach an error of 1e-11 in the angles.
    """
    law = _Law(mesh, curvature, without_face)
    u = law.start
    angles = law.angles(u)
    error = law.curvatures(angles)
    # Rounding: an angle sum of n terms carries about n eps; below that no step can help.
    tolerance = max(_TOLERANCE, 4e-16 * float(np.bincount(mesh.tail).max()))
    for step in range(_STEPS):
        if np.abs(error).max() < tolerance:
            radii = law.radii(u)
            return Packing(radii, radii[mesh.tail] + radii[mesh.head], angles.ravel(), step)
        direction = law.newton_direction(u, angles, error)
        u, angles, error, moved = law.search(u, direction, error)
        if not moved:
            break
    if np.abs(error).max() < 1e-9:
        radii = law.radii(u)
        return Packing(radii, radii[mesh.tail] + radii[mesh.head], angles.ravel(), _STEPS)
    raise MapError(
        f"the circle packing stopped at an angle error of {np.abs(error).max():.1e} (1e-11 is required); "
        "look for needle-like parts of the mesh with `orbiframe info`, or refine the mesh"
    )


class _Law:
    """Angles of three mutually tangent circles and their derivatives, for one mesh and one curvature."""

    def __init__(self, mesh: Polyhedron, curvature: int, without_face: int | None) -> None:
        self.curvature = curvature
        self.triangles = mesh.triangles
        self.fixed = np.array([], dtype=np.intp) if without_face is None else mesh.triangles[without_face]
        self.packed_faces = np.ones(len(mesh.triangles))
        if without_face is not None:
            self.packed_faces[without_face] = 0.0
        self.count = len(mesh.vertices)
        once = mesh.representative
        self.order = elimination_order(mesh.vertices, mesh.tail[once], mesh.head[once])
        self.place = np.empty(self.count, dtype=np.intp)
        self.place[self.order] = np.arange(self.count)

    @property
    def start(self) -> Floats:
        return np.full(self.count, np.log(np.tanh(0.025)) if self.curvature else 0.0)

    def radii(self, u: Floats) -> Floats:
        return 2 * np.arctanh(np.exp(u)) if self.curvature else np.exp(u)

    def _sine(self, length: Floats) -> Floats:
        return np.sinh(length) if self.curvature else length

    def angles(self, u: Floats) -> Floats:
        """Corner angles (F, 3): tan^2(theta_0 / 2) = sinh r1 sinh r2 / (sinh r0 sinh(r0 + r1 + r2))."""
        r = self.radii(u)[self.triangles]
        s = self._sine(r)
        whole = self._sine(r.sum(axis=1))
        return 2 * np.arctan(np.sqrt(np.roll(s, -1, 1) * np.roll(s, -2, 1) / (s * whole[:, None])))

    def curvatures(self, angles: Floats) -> Floats:
        """2 pi minus the angle sum at every vertex, (V,); nothing at a vertex of fixed radius."""
        sums = np.bincount(
            self.triangles.ravel(), weights=(angles * self.packed_faces[:, None]).ravel(), minlength=self.count
        )
        error = 2 * np.pi - sums
        error[self.fixed] = 0.0
        return error

    def newton_direction(self, u: Floats, angles: Floats, error: Floats) -> Floats:
        matrix = self._hessian(u, angles)
        solution = np.empty(self.count)
        solution[self.order] = factorised(matrix).solve(-error[self.order])
        return solution

    def _hessian(self, u: Floats, angles: Floats) -> coo_array:
        """Minus the derivative of the angle sums, in elimination order."""
        r = self.radii(u)[self.triangles]
        s = self._sine(r)
        opposite = self._sine(np.roll(r, -1, 1) + np.roll(r, -2, 1))
        area = np.roll(opposite, -1, 1) * np.roll(opposite, -2, 1) * np.sin(angles)
        ratio = opposite / area
        versed = 2 * np.sin(angles / 2) ** 2
        rows, columns, values = [], [], []
        for corner in range(3):
            after, before = (corner + 1) % 3, (corner + 2) % 3
            here = self.triangles[:, corner]
            rows += [here, here, here]
            columns += [self.triangles[:, after], self.triangles[:, before], here]
            cosines = np.cos(angles[:, after]) + np.cos(angles[:, before])
            values += [
                -s[:, after] * ratio[:, corner] * versed[:, after],
                -s[:, before] * ratio[:, corner] * versed[:, before],
                s[:, corner] * ratio[:, corner] * cosines,
            ]
        i, j = self.place[np.concatenate(rows)], self.place[np.concatenate(columns)]
        data = np.concatenate(values) * np.tile(self.packed_faces, 9)
        if len(self.fixed):
            held = np.isin(i, self.place[self.fixed]) | np.isin(j, self.place[self.fixed])
            data[held] = 0.0
        if self.curvature == 0:
            # Scale is free in the plane: the curvatures sum to zero, so holding one vertex changes nothing else.
            held = self.place[self.fixed] if len(self.fixed) else np.array([0])
            i, j = np.append(i, held), np.append(j, held)
            data = np.append(data, np.full(len(held), np.abs(data).mean()))
        return coo_array((data, (i, j)), shape=(self.count, self.count)).tocsc()

    def search(self, u: Floats, step: Floats, error: Floats) -> tuple[Floats, Floats, Floats, bool]:
        """The longest of 1, 1/2, 1/4, ... steps that keeps u < 0 and makes the error fall, or the slope keep its sign."""
        size = 1.0
        slope = float(error @ step)
        for _ in range(40):
            trial = u + size * step
            if self.curvature == 0 or trial.max() < 0:
                angles = self.angles(trial)
                new = self.curvatures(angles)
                falls = np.linalg.norm(new) < np.linalg.norm(error)
                if np.isfinite(new).all() and (falls or float(new @ step) * slope > 0):
                    return trial, angles, new, True
            size /= 2
        return u, self.angles(u), error, False
