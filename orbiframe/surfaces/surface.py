"""OrbifoldSurface: three functions on X/H, hence one smooth surface in space (paper, section 3.4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbiframe.errors import FitError
from orbiframe.functions.basis import Basis, DifferentiableBasis
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.subdivision import Refinement, grid_of
from orbiframe.meshes.submesh import submesh
from orbiframe.meshes.told_by_ends import refined_by_ends
from orbiframe.orbifolds.atlas import Points
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.planes.quadrature import triangle_points
from orbiframe.surfaces.places_in_triangles import require_places
from orbiframe.triangulations.crease_chains import on_crease
from orbiframe.triangulations.triangulation import Triangulation

if TYPE_CHECKING:
    from orbiframe.functions.fitter import Fitter
    from orbiframe.surfaces.field import Field
    from orbiframe.surfaces.operator import SurfaceOperator
    from orbiframe.surfaces.shaded_mesh import ShadedPicture

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_CHUNK = 1 << 16
_PICTURED = 30_000  # triangles, or about so many
# The side of a crease on which the corner of a face lies is told so far inside of the face, as a share of it.
_INSIDE = 1e-6


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


class Tessellation(NamedTuple):
    """A triangle mesh on a surface, and the points of X/H under its vertices."""

    mesh: Polyhedron
    points: Points


@dataclass(frozen=True, eq=False, repr=False)
class OrbifoldSurface:
    """The image of X/H under three functions of a basis, placed in space.

    triangulation: the map from the (refined) mesh to X/H; refinement: how that mesh refines the triangles of the
    input; basis and coefficients (size, 3): the functions; origin (3,) and scale: a value v is the point
    origin + scale * v, so that the coefficients belong to a mesh of unit size at the origin. basis_name and
    basis_options: the component that made the basis, and its options, from which a saved surface makes it again.

    >>> import numpy as np
    >>> from orbiframe import fit
    >>> surface = fit("dataset:torus", size=100).surface
    >>> points = surface.points([0, 7], np.array([[1, 1, 1], [0, 1, 2]]) / 3)  # in triangles, barycentric
    >>> surface.evaluate(points).shape, surface.normals(points).shape
    ((2, 3), (2, 3))
    >>> abs(surface.total_curvature()) < 1e-3  # 2 pi times the Euler characteristic
    True
    >>> print(surface.distance([[1.5, 0, 0]]).round(2))  # the torus has the radii 1 and 0.4
    [0.1]
    """

    triangulation: Triangulation
    refinement: Bisection
    basis: Basis
    coefficients: Floats
    origin: Floats
    scale: float
    basis_name: str = ""
    basis_options: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def own(self) -> NDArray[np.bool_]:
        """The triangles of the input that belong to the mesh, (F,); the others only close a mesh with a boundary."""
        inside = self.triangulation.inside
        facets = self.refinement.in_facets()[: self.refinement.coarse.face_count]
        return np.ones(len(facets), dtype=np.bool_) if inside is None else np.asarray(inside[facets])

    @property
    def own_mesh(self) -> Polyhedron:
        """The triangles of the input, of a mesh with a boundary without those that only close it."""
        coarse = self.refinement.coarse
        return coarse if self.triangulation.inside is None else submesh(coarse, self.own).mesh

    @property
    def orbifold(self) -> Orbifold:
        """The parameter domain X/H."""
        return self.triangulation.orbifold

    def __repr__(self) -> str:
        chi, kind = self.orbifold.euler_characteristic, "orientable" if self.orbifold.orientable else "nonorientable"
        made = f"{self.basis.size} functions" + (f" of {self.basis_name}" if self.basis_name else "")
        return f"<OrbifoldSurface: {kind}, Euler characteristic {chi}; {made}; over {self.refinement.coarse}>"

    def points(self, face: ArrayLike, barycentric: ArrayLike) -> Points:
        """The points of X/H at barycentric coordinates (n, 3) in triangles (n,) of the input mesh.

        Raises GeometryError for a triangle that is not there, and for coordinates that are negative or whose sum is not
        1; rounding is forgiven.
        """
        triangles, places = require_places(face, barycentric, self.refinement.coarse.face_count)
        return self.triangulation.locate(*self.refinement.locate(triangles, places))

    @property
    def vertex_points(self) -> Points:
        """The points of X/H of the vertices of the refined mesh."""
        return Points(self.triangulation.patch, self.triangulation.points)

    def evaluate(self, points: Points) -> Floats:
        """The surface points (n, 3) over points of X/H."""
        return np.asarray(self.origin + self.scale * self.basis.values(points, self.coefficients))

    def jet(self, points: Points) -> Jet:
        """Surface points with first and second derivatives. Raises FitError for a basis that has none.

        On a crease the derivatives are those of one of its sides, the same for the same point.
        """
        value, first, second = self._unit_jet(points)
        return Jet(self.origin + self.scale * value, self.scale * first, self.scale * second)

    def normals(self, points: Points) -> Floats:
        """Unit normals S1 x S2 / |S1 x S2| (n, 3), right-handed in the frame of the patch of each point."""
        d = self._derivatives(points, 1)
        return _unit(np.cross(d[1], d[2]))

    def curvature(self, points: Points) -> Curvature:
        """Gaussian and mean curvature over points of X/H from the two fundamental forms.

        The second form uses the covariant Hessian: what it lacks against plain second derivatives is tangential.
        """
        gaussian, mean, normal, element = self._unit_curvature(points)
        s = self.scale
        return Curvature(gaussian / s / s, mean / s, normal, element * s * s)

    def total_curvature(self, order: int = 4) -> float:
        """The integral of the Gaussian curvature over the surface: 2 pi chi by Gauss and Bonnet where it is immersed.

        That of a surface with a boundary is 2 pi chi without `boundary_turning`.

        order: Gauss points along each direction of every triangle of the triangulation.
        """
        geometry, own = self.orbifold.geometry, self.triangulation.own_faces
        lifts = self.triangulation.lifts[own]
        first_patch = self.triangulation.patch[self.triangulation.polyhedron.triangles[own, 0]]
        total = 0.0
        for start in range(0, len(lifts), max(_CHUNK // order**2, 1)):
            part = slice(start, start + max(_CHUNK // order**2, 1))
            x, weights = triangle_points(geometry, lifts[part], order)
            bent = self._unit_curvature(Points(np.repeat(first_patch[part], order**2), x.reshape(-1, 3)))
            total += float(np.abs(weights).ravel() @ (bent.gaussian * bent.element))
        return total

    def boundary_turning(self, order: int = 4) -> float:
        """By how much the boundary turns within the surface: the integral of its geodesic curvature, and its corners.

        With the total curvature it is 2 pi chi (Gauss and Bonnet); 0 for a closed surface. order: Gauss points of every
        edge of the triangulation. Raises FitError for a basis without derivatives.
        """
        from orbiframe.surfaces.border import turning

        return turning(self, order)

    def nearest(self, targets: ArrayLike) -> tuple[Points, Floats]:
        """The points of X/H whose surface points are nearest to points in space (n, 3), and the distances (n,).

        See `orbiframe.surfaces.nearest_points`.
        """
        from orbiframe.surfaces.nearest import nearest_points

        return nearest_points(self, np.asarray(targets, dtype=np.float64))

    def distance(self, targets: ArrayLike) -> Floats:
        """The distance (n,) of points in space (n, 3) to the surface."""
        return self.nearest(targets)[1]

    def picture(
        self, path: str | Path | None = None, *, width: int = 480, view: tuple[float, float, float] | None = None
    ) -> ShadedPicture:
        """A picture of the surface, which a notebook shows, written as a PNG file where a path is given.

        width: in pixels; view: the direction from the surface to the eye.
        """
        from orbiframe.surfaces.shaded_mesh import VIEW, shaded_picture

        faces = len(self.triangulation.own_faces)
        mesh = self.tessellate(max(1, round((_PICTURED / faces) ** 0.5)), bisected=True)
        made = shaded_picture(mesh, width=width, view=VIEW if view is None else view)
        if path is not None:
            made.save(path)
        return made

    def show(self) -> Any:
        """The surface to be turned in a notebook: Jupyter, marimo or VS Code; a picture where no JavaScript runs."""
        from orbiframe.components.registry import Registry

        return Registry.discover().shown(self)

    def operator(self, points: Points, order: int = 0) -> SurfaceOperator:
        """The sparse matrices from coefficients to values over points of X/H, and derivatives up to an order of 1 or 2.

        See `orbiframe.surfaces.SurfaceOperator`.
        """
        from orbiframe.surfaces.operator import surface_operator

        return surface_operator(self, points, order)

    def fit_field(
        self,
        points: Points | ArrayLike,
        values: ArrayLike,
        *,
        fitter: Fitter | None = None,
        basis: Basis | None = None,
        gradients: ArrayLike | None = None,
        fixed: ArrayLike | None = None,
    ) -> Field:
        """The smooth functions on this surface that have about these values (n,) or (n, q) at n points.

        points: of X/H, or (n, 3) in space; gradients: in space, (n, 3); fixed: (n,), data that are met exactly; see
        `orbiframe.surfaces.fit_field`.
        """
        from orbiframe.surfaces.field import fit_field

        return fit_field(self, points, values, fitter=fitter, basis=basis, gradients=gradients, fixed=fixed)

    def tessellate(self, density: int = 1, *, bisected: bool = False) -> Polyhedron:
        """A triangle mesh on the surface with normals: every triangle of the input in density^2 triangles.

        bisected: every triangle of the refined mesh instead, so that triangles are even in size and small where the
        input is thin. Watertight and of the topology of the input: every vertex is evaluated once, and the faces are
        glued as those of the input are. Creases are edges, and the corners of faces there have normals of their own.
        Where a file could not tell the edges by their ends, triangles are halved first, see `refined_by_ends`. Normals
        point to the side from which the faces run counterclockwise.
        """
        return self.tessellation(density, bisected=bisected).mesh

    def tessellation(self, density: int = 1, *, bisected: bool = False) -> Tessellation:
        """The same mesh with the points of X/H that its vertices lie over."""
        mesh = refined_by_ends(self.triangulation.polyhedron if bisected else self.refinement.coarse, density)
        face, barycentric = mesh.face, mesh.barycentric
        if not bisected:
            face, barycentric = self.refinement.locate(face, barycentric)
        points = self.triangulation.locate(face, barycentric)
        if not isinstance(self.basis, DifferentiableBasis):
            return self._bounded(mesh.polyhedron.with_vertices(self.evaluate(points)), points, mesh, bisected)
        d = self._derivatives(points, 1)
        normals = _unit(np.cross(d[1], d[2])) * self.triangulation.face_signs[face, None]
        placed = mesh.polyhedron.with_vertices(self.origin + self.scale * d[0], normals)
        if self.triangulation.crease is not None:
            placed = replace(placed, corner_normals=self._corner_normals(placed, face, barycentric, density, bisected))
        return self._bounded(placed, points, mesh, bisected)

    def _bounded(self, mesh: Polyhedron, points: Points, refined: Refinement, bisected: bool) -> Tessellation:
        """A tessellation without what only closes the mesh."""
        mesh = replace(mesh, unit=self.unit)
        if self.triangulation.inside is None:
            return Tessellation(mesh, points)
        coarse = self.triangulation.inside if bisected else self.own
        found = submesh(mesh, coarse[refined.origin])
        return Tessellation(found.mesh, Points(points.patch[found.vertices], points.x[found.vertices]))

    def _corner_normals(
        self, mesh: Polyhedron, face: Ints, barycentric: Floats, density: int, bisected: bool
    ) -> Floats | None:
        """The normals of the corners of a tessellation, (H, 3): on creases those of the side of the face.

        None for a mesh whose triangles had to be halved to tell them by their ends.
        """
        assert mesh.normals is not None
        if (
            mesh.face_count
            != density**2 * (self.triangulation.polyhedron if bisected else self.refinement.coarse).face_count
        ):
            return None
        corner = np.flatnonzero(on_crease(self.triangulation, face, barycentric)[mesh.tail])
        own = mesh.normals[mesh.tail]
        part, place = np.divmod(corner // 3, density**2)
        grid = grid_of(density)[place]
        inside = (1 - _INSIDE) * grid[np.arange(len(corner)), corner % 3] + _INSIDE * grid.mean(axis=1)
        if not bisected:
            part, inside = self.refinement.locate(part, inside)
        d = self._derivatives(self.triangulation.locate(part, inside), 1)
        own[corner] = _unit(np.cross(d[1], d[2])) * self.triangulation.face_signs[part, None]
        return own

    @property
    def unit(self) -> str | None:
        """The unit of coordinates, as far as the mesh has one: "millimetre" or "metre"."""
        return self.refinement.coarse.unit

    def _unit_curvature(self, points: Points) -> Curvature:
        """The curvature of the surface before it is scaled: no square of a very large or very small number."""
        _, slopes, bends = self._unit_jet(points)
        first, second = slopes[:, 0], slopes[:, 1]
        cross = np.cross(first, second)
        element, normal = np.linalg.norm(cross, axis=1), _unit(cross)
        e, f, g = (_dot(a, b) for a, b in ((first, first), (first, second), (second, second)))
        bend, twist, other = (_dot(bends[:, k], normal) for k in range(3))
        with np.errstate(all="ignore"):
            square = element**2
            gaussian = (bend * other - twist**2) / square
            mean = (e * other - 2 * f * twist + g * bend) / (2 * square)
        return Curvature(gaussian, mean, normal, element)

    def _unit_jet(self, points: Points) -> Jet:
        """The jet of the surface before it is placed in space."""
        d = self._derivatives(points, 2)
        return Jet(d[0], np.moveaxis(d[1:3], 0, 1), np.moveaxis(d[3:], 0, 1))

    def _derivatives(self, points: Points, order: int) -> Floats:
        if not isinstance(self.basis, DifferentiableBasis):
            raise FitError("this basis knows no derivatives; use one that does, such as 'gaussian'")
        return self.basis.jets(points, self.coefficients, order)


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("ni,ni->n", a, b))


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0, length, 1.0))
