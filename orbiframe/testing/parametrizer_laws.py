"""The laws of a map from a triangle mesh to X/H, with the group found from the mesh or named."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.geometry_names import geometry_name
from orbiframe.components.registry import Registry
from orbiframe.errors import MapError
from orbiframe.groups.marked_group import MarkedGroup
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.subdivision import refine
from orbiframe.meshes.surface_type import surface_type
from orbiframe.orbifolds.atlas import Atlas
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.planes.geometry import Geometry
from orbiframe.testing.lab import Lab
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Component = Callable[[Polyhedron, Geometry, MarkedGroup | None], Triangulation]

DENSITY = 3


def transitions_form_a_cocycle(component: Component, lab: Lab) -> None:
    """Transitions close up round every triangle, run between the right patches, and twins have inverse ones."""
    for case in _cases(component, lab):
        mesh, atlas, transition = case.mesh, case.atlas, case.result.transition
        _at_most(case, "a triangle fails to close by", case.result.relation_defect, 1e-11)
        _at_most(case, "isometries are off by", atlas.geometry.isometry_defect(atlas.isometry), 1e-11)
        _at_most(case, "inverses are off by", atlas.isometry @ atlas.isometry[atlas.inverse] - np.eye(3), 1e-11)
        back = np.where(mesh.same, transition, atlas.inverse[transition])
        assert np.array_equal(transition[mesh.twin], back), f"{case.name}: twins have transitions that do not match"
        crossing = transition > 0
        for ends, vertex in ((atlas.tail, mesh.tail), (atlas.head, mesh.head)):
            patch = case.result.patch[vertex]
            assert np.array_equal(ends[transition[crossing]], patch[crossing]), f"{case.name}: transitions of others"
        inside = case.result.patch[mesh.tail] == case.result.patch[mesh.head]
        assert inside[~crossing].all(), f"{case.name}: an edge between two patches has no transition"


def no_face_is_flipped(component: Component, lab: Lab) -> None:
    """Every triangle has positive area in X: the map is an embedding."""
    for case in _cases(component, lab):
        assert case.result.not_positive == 0, f"{case.name}: {case.result.not_positive} triangles are folded"


def areas_add_up(component: Component, lab: Lab) -> None:
    """X/H is the surface of the mesh; the triangles fill its area, which is 2 pi |chi| unless X is flat."""
    for case in _cases(component, lab):
        surface, orbifold = surface_type(case.mesh), case.result.orbifold
        assert orbifold.euler_characteristic == surface.euler_characteristic, f"{case.name}: another chi"
        assert orbifold.orientable == surface.orientable, f"{case.name}: orientability changed"
        assert orbifold.area > 0, f"{case.name}: area {orbifold.area}"
        if surface.euler_characteristic:
            excess = orbifold.area - 2 * np.pi * abs(surface.euler_characteristic)
            _at_most(case, "the area differs from 2 pi |chi| by", excess, 1e-9)
        _at_most(case, "the areas of the triangles are off by", case.result.area_defect, 1e-9)


def mesh_is_kept(component: Component, lab: Lab) -> None:
    """The result has the vertices and faces of the mesh, and for each vertex a finite point of X in a patch."""
    for case in _cases(component, lab):
        kept = case.result.polyhedron
        for name in ("vertices", "offsets", "tail", "twin", "same"):
            assert np.array_equal(getattr(kept, name), getattr(case.mesh, name)), f"{case.name}: {name} changed"
        assert case.result.points.shape == case.mesh.vertices.shape, f"{case.name}: {case.result.points.shape}"
        assert np.isfinite(case.result.points).all(), f"{case.name}: a point is not finite"
        _at_most(case, "points lie off X by", case.atlas.geometry.point_defect(case.result.points), 1e-11)
        patch = case.result.patch
        assert ((patch >= 0) & (patch < case.atlas.patch_count)).all(), f"{case.name}: a patch does not exist"


def patches_cover(component: Component, lab: Lab) -> None:
    """The corners of a triangle with a corner in a patch lie within the radius of the patch."""
    for case in _cases(component, lab):
        geometry, mesh, transition = case.atlas.geometry, case.mesh, case.result.transition
        points, radius = case.result.points, case.atlas.radius[case.result.patch[mesh.tail]]
        far = geometry.act(case.atlas.isometry[transition], points[mesh.head])
        for x in (points[mesh.tail], far):
            over = geometry.distance(geometry.origin, x) - radius
            _at_most(case, "a corner sticks out by", np.maximum(over, 0.0), 1e-9)


def order_of_faces_does_not_matter(component: Component, lab: Lab) -> None:
    """With the faces in another order, from other first corners, all edges have the same lengths in X."""
    for case in _cases(component, lab):
        order, shift = lab.rng.permutation(case.mesh.face_count), lab.rng.integers(3, size=case.mesh.face_count)
        corners = 3 * order[:, None] + (np.arange(3) + shift[:, None]) % 3
        mesh = _reordered(case.mesh, corners)
        group = None if case.group is None else _remarked(case.group, mesh, corners)
        there = component(mesh, case.atlas.geometry, group)
        error = edge_lengths(there) - edge_lengths(case.result)[corners.ravel()]
        _at_most(case, "a length in X changes by", error, 1e-6)


def numbers_of_vertices_do_not_matter(component: Component, lab: Lab) -> None:
    """With the vertices in another order, so that all computations start elsewhere, edges keep their lengths in X."""
    for case in _cases(component, lab):
        order = lab.rng.permutation(len(case.mesh.vertices))
        mesh = replace(case.mesh, vertices=case.mesh.vertices[order], tail=np.argsort(order)[case.mesh.tail])
        corners = np.arange(len(mesh.tail)).reshape(-1, 3)
        group = None if case.group is None else _remarked(case.group, mesh, corners)
        there = component(mesh, case.atlas.geometry, group)
        _at_most(case, "a length in X changes by", edge_lengths(there) - edge_lengths(case.result), 1e-6)


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    transitions_form_a_cocycle,
    no_face_is_flipped,
    areas_add_up,
    mesh_is_kept,
    patches_cover,
    order_of_faces_does_not_matter,
    numbers_of_vertices_do_not_matter,
)


# ---- mutants --------------------------------------------------------------------------------------------------------


def _altered(change: Callable[[Triangulation], Triangulation]) -> Callable[[Component], Component]:
    return lambda component: lambda mesh, geometry, group: change(component(mesh, geometry, group))


def _with_orbifold(result: Triangulation, orbifold: Orbifold) -> Triangulation:
    return replace(result, orbifold=orbifold)


def _with_atlas(result: Triangulation, **changes: Any) -> Triangulation:
    return _with_orbifold(result, replace(result.orbifold, atlas=replace(result.orbifold.atlas, **changes)))


def _bent(result: Triangulation) -> Triangulation:
    """The transitions turned a little, without regard to the relations."""
    atlas = result.orbifold.atlas
    return _with_atlas(result, isometry=atlas.isometry @ atlas.geometry.rotation(0.001))


def _moved(result: Triangulation, times: float, edge: int = 0) -> Triangulation:
    """The tail of a halfedge moved towards its head, so many times the length of the edge."""
    atlas, mesh, points = result.orbifold.atlas, result.polyhedron, result.points.copy()
    here = points[mesh.tail[edge]]
    there = atlas.geometry.act(atlas.isometry[result.transition[edge]], points[mesh.head[edge]])
    points[mesh.tail[edge]] = atlas.geometry.exp(here, times * atlas.geometry.log(here, there))
    return replace(result, points=points)


MUTANTS: dict[str, Callable[[Component], Component]] = {
    "transitions_form_a_cocycle": _altered(_bent),
    "no_face_is_flipped": _altered(lambda result: _moved(result, 1.5)),
    "areas_add_up": _altered(lambda r: _with_orbifold(r, replace(r.orbifold, area=1.001 * r.orbifold.area))),
    "mesh_is_kept": _altered(
        lambda result: replace(result, polyhedron=result.polyhedron.with_vertices(2 * result.polyhedron.vertices))
    ),
    "patches_cover": _altered(lambda result: _with_atlas(result, radius=0.5 * result.orbifold.atlas.radius)),
    "order_of_faces_does_not_matter": _altered(lambda result: _moved(result, 0.1)),
    "numbers_of_vertices_do_not_matter": _altered(
        lambda result: _moved(result, 0.1, int(result.polyhedron.tail.argmin()))
    ),
}


# ---- things to try --------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Case:
    name: str
    mesh: Polyhedron
    group: MarkedGroup | None
    result: Triangulation

    @property
    def atlas(self) -> Atlas:
        return self.result.orbifold.atlas


def edge_lengths(result: Triangulation) -> Floats:
    """The length in X of every lifted halfedge, (H,)."""
    atlas, mesh = result.orbifold.atlas, result.polyhedron
    far = atlas.geometry.act(atlas.isometry[result.transition], result.points[mesh.head])
    return atlas.geometry.distance(result.points[mesh.tail], far)


def _cases(component: Component, lab: Lab) -> Iterator[_Case]:
    """The maps of the reference polyhedra; the component may decline a surface that is not for it with MapError.

    It is asked for a map to the group of the mesh, and where it declines, to that of the regular polygon.
    """
    taken, refusals = 0, []
    for name, polyhedron in lab.polyhedra.items():
        mesh = refine(triangulated(polyhedron), DENSITY).polyhedron
        geometry = _geometry(geometry_name(surface_type(mesh).euler_characteristic))
        for make in (_no_group, _regular_group):
            group = make(mesh, geometry)
            try:
                result = component(mesh, geometry, group)
            except MapError as error:
                refusals.append(f"{name}: {error}")
                continue
            taken += 1
            yield _Case(name, mesh, group, result)
            break
    assert taken, "the component takes none of the reference polyhedra: " + "; ".join(refusals)


def _no_group(_mesh: Polyhedron, _geometry: Geometry) -> None: ...


def _regular_group(mesh: Polyhedron, geometry: Geometry) -> MarkedGroup:
    registry = Registry.discover(only=["groups", "markers"])
    marking = registry.load("marker", "tree-cotree")(mesh)
    return MarkedGroup(registry.load("group", "regular-polygon")(geometry, marking.word), marking, "regular-polygon")


def _remarked(group: MarkedGroup, mesh: Polyhedron, corners: NDArray[np.intp]) -> MarkedGroup:
    """The same group and marking on the mesh with its corners (F, 3) in another order."""
    old, marking = corners.ravel(), group.marking
    new = np.argsort(old)
    marked = replace(marking, polyhedron=mesh, position=marking.position[old], sides=new[marking.sides])
    return replace(group, marking=marked)


@cache
def _geometry(name: str) -> Geometry:
    return cast(Geometry, Registry.discover(only=["geometries"]).load("geometry", name)())


def _reordered(mesh: Polyhedron, corners: NDArray[np.intp]) -> Polyhedron:
    """The mesh with its corners (F, 3), old halfedges, in another order; corners of a face stay in their cycle."""
    old = corners.ravel()
    new = np.argsort(old)
    return Polyhedron(mesh.vertices, mesh.offsets, mesh.tail[old], new[mesh.twin[old]], mesh.same[old])


def _at_most(case: _Case, words: str, error: Floats | float, allowed: float) -> None:
    worst = float(np.abs(error).max())
    assert worst <= allowed, f"{case.name}: {words} {worst:.3g}, allowed is {allowed:.3g}"
