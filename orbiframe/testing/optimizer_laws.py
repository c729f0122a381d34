"""The laws of an optimizer: it changes a map to X/H so that its triangles get wished shapes."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.registry import Registry
from orbiframe.groups.marked_group import MarkedGroup
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.planes.geometry import Geometry
from orbiframe.testing import parametrizer_laws as maps
from orbiframe.testing.lab import Lab
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Component = Callable[[Triangulation, Floats], Triangulation]

_PARAMETRIZER = {1: "sphere", 0: "harmonic", -1: "harmonic"}


def transitions_form_a_cocycle(component: Component, lab: Lab) -> None:
    """Transitions close up round every triangle, run between the right patches, and twins have inverse ones."""
    maps.transitions_form_a_cocycle(_as_map(component), lab)


def no_face_is_flipped(component: Component, lab: Lab) -> None:
    """Every triangle has positive area in X: the map is still an embedding."""
    maps.no_face_is_flipped(_as_map(component), lab)


def areas_add_up(component: Component, lab: Lab) -> None:
    """X/H is the surface of the mesh; the triangles fill its area, which is 2 pi |chi| unless X is flat."""
    maps.areas_add_up(_as_map(component), lab)


def mesh_is_kept(component: Component, lab: Lab) -> None:
    """The result has the vertices and faces of the mesh, and for each vertex a finite point of X in a patch."""
    maps.mesh_is_kept(_as_map(component), lab)


def patches_cover(component: Component, lab: Lab) -> None:
    """The corners of a triangle with a corner in a patch lie within the radius of the patch."""
    maps.patches_cover(_as_map(component), lab)


def order_of_faces_does_not_matter(component: Component, lab: Lab) -> None:
    """With the faces in another order, from other first corners, all edges have the same lengths in X."""
    maps.order_of_faces_does_not_matter(_as_map(component), lab)


def shapes_improve(component: Component, lab: Lab) -> None:
    """Where triangles of equal sides are wished, the mean distortion of theirs does not grow."""
    for name, first in lab.triangulations.items():
        target = _equilateral(first.polyhedron)
        before, after = distortion(first, target).mean(), distortion(component(first, target), target).mean()
        assert after <= before * (1 + 1e-3), f"{name}: the mean distortion grows from {before:.6g} to {after:.6g}"


def wished_shapes_are_left_alone(component: Component, lab: Lab) -> None:
    """A flat map whose triangles have the wished shapes keeps them."""
    for name, first in lab.triangulations.items():
        if first.orbifold.geometry.curvature == 0:
            target = first.lifts[..., 1:] * np.stack([np.ones(len(first.lifts)), first.face_signs], axis=1)[:, None]
            worst = float(distortion(component(first, target), target).max())
            assert worst < 1 + 1e-6, f"{name}: a triangle with the wished shape is distorted by {worst:.9g}"


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    transitions_form_a_cocycle,
    no_face_is_flipped,
    areas_add_up,
    mesh_is_kept,
    patches_cover,
    order_of_faces_does_not_matter,
    shapes_improve,
    wished_shapes_are_left_alone,
)


# ---- mutants --------------------------------------------------------------------------------------------------------


def _of_map(name: str) -> Callable[[Component], Component]:
    """The mutation of that name of maps, on what an optimizer makes."""

    def mutated(component: Component) -> Component:
        def broken(first: Triangulation, target: Floats) -> Triangulation:
            made = maps.MUTANTS[name](lambda *_: component(first, target))
            return made(first.polyhedron, first.orbifold.geometry, None)

        return broken

    return mutated


def _asked_for(change: Callable[[Floats], Floats]) -> Callable[[Component], Component]:
    return lambda component: lambda first, target: component(first, change(target))


MUTANTS: Mapping[str, Callable[[Component], Component]] = {
    **{law.__name__: _of_map(law.__name__) for law in LAWS[:6]},
    "shapes_improve": _asked_for(lambda target: target * np.array([3.0, 1.0])),
    "wished_shapes_are_left_alone": _asked_for(lambda target: target * np.array([1.01, 1.0])),
}


# ---- things to try --------------------------------------------------------------------------------------------------


def distortion(made: Triangulation, target: Floats) -> Floats:
    """(a/b + b/a)/2 for the singular values of the linear map from each wished triangle to the one in X, (F,).

    By the sides alone: both triangles as Euclidean ones with their sides, the sum of cotangents times squares over
    four times the area.
    """
    wished = _sides(target, lambda a, b: np.linalg.norm(b - a, axis=-1))
    found = _sides(made.lifts, made.orbifold.geometry.distance)
    squares = (np.roll(found, -1, axis=1) ** 2 + np.roll(found, -2, axis=1) ** 2 - found**2) * wished**2
    return np.asarray(squares.sum(axis=1) / (16 * _heron(wished) * _heron(found)))


def _sides(corners: Floats, distance: Callable[[Floats, Floats], Floats]) -> Floats:
    return np.asarray(distance(corners, np.roll(corners, -1, axis=1)))


def _heron(sides: Floats) -> Floats:
    s = sides.sum(axis=1) / 2
    return np.asarray(np.sqrt(np.maximum(s * np.prod(s[:, None] - sides, axis=1), 0.0)))


def _equilateral(mesh: Polyhedron) -> Floats:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(0.75)]])
    return np.tile(corners, (mesh.face_count, 1, 1))


def _as_map(component: Component) -> maps.Component:
    """The component as a parametrizer: it asks for triangles of equal sides, from the map of an installed one."""
    registry = Registry.discover(only=["parametrizers"])

    def mapped(mesh: Polyhedron, geometry: Geometry, _group: MarkedGroup | None) -> Triangulation:
        first = registry.load("parametrizer", _PARAMETRIZER[geometry.curvature])(mesh, geometry, None)
        return component(first, _equilateral(mesh))

    return mapped
