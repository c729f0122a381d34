"""OrbifoldSurface: three functions on X/H, hence one smooth surface in space (paper, section 3.4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.atlas import Points
from orbiframe.basis import Basis, DifferentiableBasis
from orbiframe.bisection import Bisection
from orbiframe.errors import FitError
from orbiframe.orbifold import Orbifold
from orbiframe.polyhedron import Polyhedron
from orbiframe.quadrature import triangle_points
from orbiframe.refinement import refine
from orbiframe.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_CHUNK = 1 << 16


class Jet(NamedTuple):
    """A surface point with derivatives, in the orthonormal frame of X at the parameter point.

    value: (n, 3); first: (n, 2, 3), S1 and S2; second: (n, 3, 3), the covariant Hessian S11, S12, S22.
    """

    value: Floats
    first: Floats
    second: Floats


class Curvature(NamedTuple):
    """Gaussian and mean curvature (n,), the unit normal (n, 3) and the area element |S1 x S2| (n,) of a surface.

    The mean curvature is positive where the surface bends towards its normal.
    """

    gaussian: Floats
    mean: Floats
    normal: Floats
    element: Floats


@dataclass(frozen=True, eq=False)
class OrbifoldSurface:
    """The image of X/H under three functions of a basis, placed in space.

    triangulation: the map from the (refined) mesh to X/H; refinement: how that mesh refines the triangles of the
    input; basis and coefficients (size, 3): the functions; origin (3,) and scale: a value v is the point
    origin + scale * v, so that the coefficients belong to a mesh of unit size at the origin. basis_name and
    basis_options: the component that made the basis, and its options, from which a saved surface makes it again.
    """

    triangulation: Triangulation
    refinement: Bisection
    basis: Basis
    coefficients: Floats
    origin: Floats
    scale: float
    basis_name: str = ""
    basis_options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def orbifold(self) -> Orbifold:
        """The parameter domain X/H."""
        return self.triangulation.orbifold

    def points(self, face: Ints, barycentric: Floats) -> Points:
        """The points of X/H at barycentric coordinates (n, 3) in triangles (n,) of the input mesh."""
        return self.triangulation.locate(*self.refinement.locate(face, barycentric))

    def evaluate(self, points: Points) -> Floats:
        """The surface points (n, 3) over points of X/H."""
        parts = [self.basis.design_matrix(part) @ self.coefficients for part in _chunks(points)]
        return np.asarray(self.origin + self.scale * np.concatenate(parts))

    def jet(self, points: Points) -> Jet:
        """Surface points with first and second derivatives. Raises FitError for a basis that has none."""
        parts = [self._derivatives(part, 2) for part in _chunks(points)]
        d = self.scale * np.concatenate(parts, axis=1)
        return Jet(self.origin + d[0], np.stack(d[1:3], axis=1), np.stack(d[3:], axis=1))

    def normals(self, points: Points) -> Floats:
        """Unit normals S1 x S2 / |S1 x S2| (n, 3), right-handed in the frame of the patch of each point."""
        d = np.concatenate([self._derivatives(part, 1)[1:] for part in _chunks(points)], axis=1)
        return _unit(np.cross(d[0], d[1]))

    def curvature(self, points: Points) -> Curvature:
        """Gaussian and mean curvature over points of X/H from the two fundamental forms.

        The second form uses the covariant Hessian: what it lacks against plain second derivatives is tangential.
        """
        jet = self.jet(points)
        cross = np.cross(jet.first[:, 0], jet.first[:, 1])
        element = np.linalg.norm(cross, axis=1)
        normal = _unit(cross)
        e, f, g = (np.einsum("ni,ni->n", jet.first[:, a], jet.first[:, b]) for a, b in ((0, 0), (0, 1), (1, 1)))
        l, m, n = np.einsum("nki,ni->kn", jet.second, normal)
        with np.errstate(all="ignore"):
            square = element**2
            gaussian = (l * n - m * m) / square
            mean = (e * n - 2 * f * m + g * l) / (2 * square)
        return Curvature(gaussian, mean, normal, element)

    def total_curvature(self, order: int = 4) -> float:
        """The integral of the Gaussian curvature over the surface: 2 pi chi by Gauss and Bonnet where it is immersed.

        order: Gauss points along each direction of every triangle of the triangulation.
        """
        geometry, lifts = self.orbifold.geometry, self.triangulation.lifts
        first_patch = self.triangulation.patch[self.triangulation.polyhedron.triangles[:, 0]]
        total = 0.0
        for start in range(0, len(lifts), max(_CHUNK // order**2, 1)):
            part = slice(start, start + max(_CHUNK // order**2, 1))
            x, weights = triangle_points(geometry, lifts[part], order)
            bent = self.curvature(Points(np.repeat(first_patch[part], order**2), x.reshape(-1, 3)))
            total += float(np.abs(weights).ravel() @ (bent.gaussian * bent.element))
        return total

    def tessellate(self, density: int = 1) -> Polyhedron:
        """A triangle mesh on the surface with normals: every triangle of the input in density^2 triangles.

        Watertight and of the topology of the input: every vertex is evaluated once, and the faces are glued as those
        of the input are. Normals point to the side from which the faces run counterclockwise.
        """
        mesh = refine(self.refinement.coarse, density)
        face, barycentric = self.refinement.locate(mesh.face, mesh.barycentric)
        points = self.triangulation.locate(face, barycentric)
        if not isinstance(self.basis, DifferentiableBasis):
            return mesh.polyhedron.with_vertices(self.evaluate(points))
        d = np.concatenate([self._derivatives(part, 1) for part in _chunks(points)], axis=1)
        normals = _unit(np.cross(d[1], d[2])) * self.triangulation.face_signs[face, None]
        return mesh.polyhedron.with_vertices(self.origin + self.scale * d[0], normals)

    def _derivatives(self, points: Points, order: int) -> Floats:
        if not isinstance(self.basis, DifferentiableBasis):
            raise FitError("this basis knows no derivatives; use one that does, such as 'gaussian'")
        return np.stack([matrix @ self.coefficients for matrix in self.basis.jet_matrices(points, order)])


def _chunks(points: Points) -> list[Points]:
    bounds = range(0, max(len(points.patch), 1), _CHUNK)
    return [Points(points.patch[b : b + _CHUNK], points.x[b : b + _CHUNK]) for b in bounds]


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0, length, 1.0))
