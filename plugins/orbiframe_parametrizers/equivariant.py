"""Equivariant: the harmonic map of a surface with chi <= 0 to X/H for a named group H."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal, NamedTuple

import numpy as np
from annotated_types import Ge
from numpy.typing import NDArray

from orbiframe import Atlas, Geometry, MapError, Orbifold, Polyhedron, SurfaceType, Triangulation, surface_type
from orbiframe.groups import MarkedGroup
from orbiframe.planes import PreciseIsometry
from orbiframe_parametrizers.developing import in_patches, on_both_halfedges
from orbiframe_parametrizers.edge_weights import WEIGHTS
from orbiframe_parametrizers.embedding import embedded
from orbiframe_parametrizers.even_areas import evened
from orbiframe_parametrizers.unfolding import unfolded

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_RELATIONS = 1e-12
_AREA = 1e-9


def equivariant(
    polyhedron: Polyhedron,
    geometry: Geometry,
    group: MarkedGroup | None = None,
    *,
    weights: Literal["auto", "cotangent", "mixed", "mean-value", "uniform"] = "auto",
    even_areas: Annotated[int, Ge(0)] = 0,
) -> Triangulation:
    """The harmonic map to the surface X/H of a named group, in the homotopy class of the marking.

    All vertices start at the centre of the polygon of H, and Newton's method unfolds them (section 3.4, steps 1 to 3).
    The frames of neighbours in this map give patches near the origin, in which the map is harmonic once more, with all
    digits. polyhedron: a closed connected triangle mesh with chi <= 0, coherently oriented if orientable; geometry: of
    the group; group: a marking of this mesh and a group with its word. weights, even_areas: as for the map `harmonic`.
    Raises MapError if no group is named, if the marking is of another mesh, if the surface does not live on the
    geometry, or if no map without a fold and with all relations is found.
    """
    surface = surface_type(polyhedron)
    _require(polyhedron, geometry, group, surface)
    assert group is not None
    try:
        result = evened(embedded(_layout(polyhedron, geometry, group, surface), weights), even_areas)
    except MapError as error:
        raise MapError(f"{_refused(group)}: {error}") from error
    if not (result.relation_defect < _RELATIONS and _area_defect(result, group) < _AREA):
        raise MapError(
            f"{_refused(group)}: its relations hold to {result.relation_defect:.0e} and its area to "
            f"{_area_defect(result, group):.0e}"
        )
    return result


def _refused(group: MarkedGroup) -> str:
    return (
        f"the map to the group '{group.name}' with {len(group.group.word)} sides fails; refine the mesh, or let the "
        "group come from it (group.method = 'mesh')"
    )


def _area_defect(result: Triangulation, group: MarkedGroup) -> float:
    return float(abs(result.areas.sum() / group.group.area - 1.0))


def _require(mesh: Polyhedron, geometry: Geometry, group: MarkedGroup | None, surface: SurfaceType) -> None:
    chi = surface.euler_characteristic
    if group is None:
        raise MapError("this map needs a named group; set group.method = 'regular-polygon' or map.method = 'harmonic'")
    if chi > 0 or np.sign(chi) != geometry.curvature or group.group.geometry.curvature != geometry.curvature:
        raise MapError(f"a surface with chi = {chi} and {group.source} do not both live on {geometry.name}")
    if len(group.marking.position) != len(mesh.tail):
        raise MapError(
            f"the marking has {len(group.marking.position)} corners, the mesh {len(mesh.tail)}; mark this mesh"
        )


def _layout(mesh: Polyhedron, geometry: Geometry, group: MarkedGroup, surface: SurfaceType) -> Triangulation:
    """The map in patches, near its minimum."""
    lifts = _CornerLifts.of(mesh, group)
    points = _unfolded(mesh, geometry, lifts, surface)
    steps = _steps(mesh, geometry, lifts, points)
    lengths = geometry.distance(geometry.origin, steps[..., 0])
    if geometry.curvature == 0:
        lengths *= np.sqrt(4 * np.pi / group.group.area)
    layout = in_patches(mesh, geometry, lengths, steps, surface=surface, patch_radius=1.0)
    return replace(layout, group=group.source)


class _CornerLifts(NamedTuple):
    """For every corner the deck transformation from the lift of its vertex to the corner of the lifted face.

    Faces are lifted into the polygon. The lift of a vertex is that in one of its corners, at position p; at position c
    the vertex is seen by g_c g_p^-1, the identity where p and c are the same. element: the distinct ones, of which the
    first is the identity; number: (H,), that of every corner.
    """

    element: PreciseIsometry
    number: Ints

    @classmethod
    def of(cls, mesh: Polyhedron, group: MarkedGroup) -> _CornerLifts:
        """The lifts for a marking of the mesh and a group with its word."""
        position, size = group.marking.position, len(group.group.word)
        own = np.empty(len(mesh.vertices), dtype=np.intp)
        own[mesh.tail[::-1]] = position[::-1]
        # Equal positions have the key 0, which stands for the identity.
        moved = position != own[mesh.tail]
        key = np.where(moved, position * size + own[mesh.tail], 0)
        keys, number = np.unique(np.append(key, 0), return_inverse=True)
        corner, vertex = np.divmod(keys, size)
        return cls(group.elements[corner] @ group.elements[vertex].inverse, number[:-1])

    def isometries(self, mesh: Polyhedron) -> tuple[Floats, Ints]:
        """The isometries (n, 3, 3) along edges, the identity first, and which of them every halfedge (H,) has."""
        count = len(self.element.a)
        after = self.number[mesh.next]
        key = np.where(self.number == after, 0, self.number * count + after)
        keys, number = np.unique(np.append(key, 0), return_inverse=True)
        tail, head = np.divmod(keys, count)
        isometry = (self.element[tail].inverse @ self.element[head]).matrix
        isometry[0] = np.eye(3)
        return isometry, number[:-1]


def _unfolded(mesh: Polyhedron, geometry: Geometry, lifts: _CornerLifts, surface: SurfaceType) -> Floats:
    """The points (V, 3) of the harmonic map with positive weights, in the frame of the polygon, to some digits."""
    isometry, transition = lifts.isometries(mesh)
    ends = np.zeros(len(isometry), dtype=np.intp)
    atlas = Atlas(geometry, np.array([np.inf]), ends, ends, ends, isometry)
    orbifold = Orbifold(atlas, surface.euler_characteristic, surface.orientable, 1.0)
    start = np.tile(geometry.origin, (len(mesh.vertices), 1))
    weights = WEIGHTS["mean-value"](mesh)
    if not (np.isfinite(weights).all() and (weights > 0).all()):
        weights = WEIGHTS["uniform"](mesh)
    patch = np.zeros(len(mesh.vertices), dtype=np.intp)
    return unfolded(Triangulation(orbifold, mesh, patch, start, transition), weights)


def _steps(mesh: Polyhedron, geometry: Geometry, lifts: _CornerLifts, points: Floats) -> Floats:
    """For every halfedge from i to j the isometry from the frame at j to the frame at i, (H, 3, 3).

    The frame at a vertex is carried from the origin to its point along a geodesic; no step is longer than its edge.
    """
    at_vertex = PreciseIsometry.translation(geometry.curvature, points)
    edges = np.flatnonzero(mesh.representative)
    here, there = (lifts.element[lifts.number[h]] @ at_vertex[mesh.tail[h]] for h in (edges, mesh.next[edges]))
    return on_both_halfedges(mesh, geometry, edges, (here.inverse @ there).matrix)
