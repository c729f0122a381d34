"""Border samples: the boundary of a mesh as data that hold a surface there, where nothing goes on beyond."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.samples import Samples, joined
from orbiframe.functions.smooth_samples import inside_facets, sagittas
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.orbifolds.atlas import Points
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# An edge whose arc is higher than this share of the distance of functions stands for something curved, if it turns by
# an angle between these: below it is straight, above there is a corner.
_SAGITTA = 0.002
# Points of a smooth boundary count so many times as much as those of a straight edge: nothing else holds it.
_GIVEN = 4.0
_STRAIGHT, _CORNER = np.radians(3), np.radians(40)


def with_border(
    samples: Samples,
    triangulation: Triangulation,
    refinement: Bisection,
    spacing: float,
    *,
    arcs: bool,
) -> Samples:
    """The samples of a mesh and those of its boundary, which are held; the same samples where it is closed.

    At the vertices of the refined mesh and the middles between them (Simpson's rule), weighted by length times the
    spacing of functions. arcs: whether edges stand for arcs, of which vertices of the mesh alone are true: never,
    or where they turn by 3 to 40 degrees, or their facets are bent so, the less the higher the arc over them is.
    """
    if not len(triangulation.border):
        return samples
    if not arcs:
        return joined(samples, _along(triangulation, refinement, spacing, np.ones(len(triangulation.border))))
    given = joined(samples, _at_vertices(triangulation, refinement, spacing))
    straight = _straight(triangulation, refinement, spacing)
    return joined(given, _along(triangulation, refinement, spacing, straight))


def _at_vertices(triangulation: Triangulation, refinement: Bisection, spacing: float) -> Samples:
    """The vertices of the mesh on its boundary, each with half of the two edges there."""
    facets = refinement.facets
    border = _border_of_facets(triangulation, refinement)
    count = len(refinement.coarse.vertices)
    length = np.zeros(len(facets.vertices))
    for ends in (facets.tail, facets.head):
        np.add.at(length, ends[border], facets.edge_lengths[border] / 2)
    vertex = np.flatnonzero(length[:count] > 0)
    points = Points(triangulation.patch[vertex], triangulation.points[vertex])
    return _held(points, facets.vertices[vertex], _GIVEN * length[vertex] * spacing)


def _along(triangulation: Triangulation, refinement: Bisection, spacing: float, share: Floats) -> Samples:
    """Ends and middles of the edges of the refined mesh on the boundary, which count so much, (n,)."""
    flat, border = refinement.polyhedron, triangulation.border
    weight = flat.edge_lengths[border] * share * spacing
    at_end = np.zeros(len(flat.vertices))
    for ends in (flat.tail, flat.head):
        np.add.at(at_end, ends[border], weight / 6)
    vertex = np.flatnonzero(at_end > 0)
    middle = np.zeros((len(border), 3))
    middle[np.arange(len(border)), border % 3] = middle[np.arange(len(border)), (border + 1) % 3] = 0.5
    located = triangulation.locate(border // 3, middle)
    points = Points(
        np.concatenate([triangulation.patch[vertex], located.patch]),
        np.concatenate([triangulation.points[vertex], located.x]),
    )
    between = (flat.vertices[flat.tail[border]] + flat.vertices[flat.head[border]]) / 2
    return _held(points, np.concatenate([flat.vertices[vertex], between]), np.append(at_end[vertex], 4 / 6 * weight))


def _border_of_facets(triangulation: Triangulation, refinement: Bisection) -> Ints:
    """The halfedges of facets on the boundary."""
    facets, inside = refinement.facets, inside_facets(triangulation, refinement)
    return np.flatnonzero(inside[facets.face] & ~inside[facets.face[facets.twin]])


def _straight(triangulation: Triangulation, refinement: Bisection, spacing: float) -> Floats:
    """How much each fine edge of the boundary counts, (n,): 1 on straight ones, less where they stand for arcs."""
    facets, border = refinement.facets, _border_of_facets(triangulation, refinement)
    turn = _turns(facets, border)
    at_ends = np.maximum(turn[facets.tail[border]], turn[facets.head[border]])
    height = np.zeros(len(facets.tail))
    area, inside = np.linalg.norm(vector_areas(facets), axis=1), inside_facets(triangulation, refinement)
    over_face = sagittas(facets, area, apart=inside)[facets.face[border]]
    height[border] = np.maximum(facets.edge_lengths[border] * at_ends / 8, over_face)
    # Every fine edge of the boundary lies in the facet edge whose ends have the barycentric coordinates that it has.
    own = np.concatenate([np.tile(np.eye(3), (facets.face_count, 1, 1)), np.zeros((facets.face_count, 3, 1))], axis=2)
    own[:, :, 3] = np.arange(facets.face_count)[:, None]
    fine = refinement.spread(own)
    face, side = np.divmod(triangulation.border, 3)
    middle = (fine[face, side] + fine[face, (side + 1) % 3]) / 2
    edge = 3 * np.rint(middle[:, 3]).astype(np.intp) + (middle[:, :3].argmin(axis=1) + 1) % 3
    return np.asarray(1 / (1 + (height[edge] / (_SAGITTA * spacing)) ** 2))


def _turns(mesh: Polyhedron, border: Ints) -> Floats:
    """By how much the boundary turns at each vertex, (V,), where it is neither straight nor a corner; else 0."""
    way = mesh.vertices[mesh.head[border]] - mesh.vertices[mesh.tail[border]]
    way /= np.maximum(np.linalg.norm(way, axis=1), np.finfo(float).tiny)[:, None]
    into, out = np.zeros((len(mesh.vertices), 3)), np.zeros((len(mesh.vertices), 3))
    # On a band that is not orientable halfedges run either way: the two directions away from a vertex tell its turn.
    seen = np.zeros(len(mesh.vertices), dtype=np.bool_)
    for vertex, direction in ((mesh.tail[border], way), (mesh.head[border], -way)):
        for v, d in zip(vertex.tolist(), direction, strict=True):
            (out if seen[v] else into)[v] = d
            seen[v] = True
    cosine = np.clip(-np.einsum("vi,vi->v", into, out), -1, 1)
    turn = np.where(seen, np.arccos(cosine), 0.0)
    return np.where((turn > _STRAIGHT) & (turn < _CORNER), turn, 0.0)


def _held(points: Points, values: Floats, weights: Floats) -> Samples:
    """Samples that are held, and ask for no fairness."""
    count = len(weights)
    none = np.zeros(count)
    return Samples(points, values, weights, none, none, none, held=np.ones(count, dtype=np.bool_))
