"""Samples of what a mesh stands for: a smooth surface through its vertices, all over or where its facets are curved."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.functions.samples import Samples, fair_shares, places
from orbiframe.meshes.bending import SHARP, bending
from orbiframe.meshes.bisection import Bisection
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.triangulations.local_girth import girth
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Fairness acts on lengths up to that of a facet, and of half a girth.
_OF_GIRTH = 0.5
# A facet whose arc is higher than this share of the distance of functions stands for something curved.
_SAGITTA = 0.002
_FLAT = np.radians(3)
# The size of facets, whose sixth power weighs fairness, is averaged so often with those about: vertices that are
# scattered unevenly say nothing of how the surface bends.
_ROUNDS = 4
# A triangle so many times as wide as its neighbour does not belong to the same arc.
_WIDE = 3.0


def vertex_samples(triangulation: Triangulation, refinement: Bisection, noise: float | None = None) -> Samples:
    """The vertices of the coarse mesh alone, as points of a smooth surface; between them fairness of order three.

    A vertex counts like a third of the area of its triangles. The length of fairness is that of the facets about.
    noise: the root mean square error of each coordinate of the vertices, where it is known.
    """
    mesh, coarse, inside = triangulation.polyhedron, refinement.facets, inside_facets(triangulation, refinement)
    area, count = np.linalg.norm(vector_areas(coarse), axis=1), len(refinement.coarse.vertices)
    everywhere = places(triangulation).take(np.arange(len(mesh.vertices)))
    weights, values = np.zeros(len(mesh.vertices)), mesh.vertices.copy()
    weights[:count], values[:count] = around_vertices(coarse, area * inside / 3)[:count], coarse.vertices[:count]
    fair = 1.0 if triangulation.inside is None else fair_shares(triangulation.inside)
    share = around_vertices(mesh, fair * np.linalg.norm(vector_areas(mesh), axis=1) / 3)
    length = lengths(triangulation, refinement, _evened(coarse, area))[: len(mesh.vertices)]
    return _fair(Samples(everywhere.points, values, weights, everywhere.stretch, share, length, 3, noise))


def semi_smooth_samples(triangulation: Triangulation, refinement: Bisection, spacing: float) -> Samples:
    """Vertices where facets are curved, the facets themselves where they are flat; fairness of order three.

    A facet is curved if an edge bends it between 3 and 40 degrees; its sagitta is the largest height of the arcs over
    it that have these bends at their ends. Its samples count the less the larger that is against the spacing of the
    functions. Fairness acts on the length of curved facets, and on the spacing elsewhere.
    """
    coarse, flat = refinement.facets, refinement.polyhedron
    area = np.linalg.norm(vector_areas(coarse), axis=1)
    inside = inside_facets(triangulation, refinement)
    sagitta = np.where(inside, sagittas(coarse, area, apart=inside), 0)
    everywhere = places(triangulation)
    share = 1 / (1 + (at_samples(triangulation, refinement, sagitta) / (_SAGITTA * spacing)) ** 2)
    weights, count = everywhere.weights * share, len(refinement.coarse.vertices)
    weights[:count] = np.maximum(weights[:count], around_vertices(coarse, np.where(sagitta > 0, area / 3, 0))[:count])
    long = np.maximum(lengths(triangulation, refinement, area), spacing)
    length = np.where(at_samples(triangulation, refinement, (sagitta > 0).astype(float)) > 0.5, long, spacing)
    values = np.concatenate([flat.vertices, flat.vertices[flat.triangles].mean(axis=1)])
    return _fair(Samples(everywhere.points, values, weights, everywhere.stretch, everywhere.shares, length, 3))


def _fair(samples: Samples) -> Samples:
    """Those of the samples that count for anything."""
    return samples.take(np.flatnonzero((samples.weights > 0) | (samples.shares > 0)))


def inside_facets(triangulation: Triangulation, refinement: Bisection) -> Bools:
    """Which of the facets belong to the mesh, (F,), and do not only close it."""
    if triangulation.inside is None:
        return np.ones(refinement.facets.face_count, dtype=np.bool_)
    return np.asarray(triangulation.inside[refinement.in_facets()])


def sagittas(mesh: Polyhedron, area: Floats, crease: Bools | None = None, *, apart: Bools | None = None) -> Floats:
    """For each triangle the largest of angle times height / 8 over its edges that are bent but not sharp.

    crease: (H,), which edges are sharp, by default those that bend by more than 40 degrees. Where creases are known, a
    triangle that is much wider than its neighbour is the plane in which a round ends, and no arc. apart: (F,), a mark;
    no triangle is bent where one beside it has another mark.
    """
    angle = bending(mesh).angle
    if apart is not None:
        angle = np.where(apart[mesh.face] == apart[mesh.face[mesh.twin]], angle, 0)
    curved = np.where((angle > _FLAT) & ~(angle >= SHARP if crease is None else crease), angle, 0.0)
    height = 2 * area[mesh.face] / np.maximum(mesh.edge_lengths, np.finfo(float).tiny)
    if crease is not None:
        curved[height > _WIDE * height[mesh.twin]] = 0.0
    return np.asarray((curved * height / 8).reshape(-1, 3).max(axis=1))


def _evened(mesh: Polyhedron, area: Floats) -> Floats:
    """Areas of triangles like those of the triangles about them: means of means at their corners, a few times."""
    degree = np.maximum(np.bincount(mesh.tail, minlength=len(mesh.vertices)), 1)
    for _ in range(_ROUNDS):
        area = (around_vertices(mesh, area) / degree)[mesh.triangles].mean(axis=1)
    return area


def lengths(triangulation: Triangulation, refinement: Bisection, area: Floats) -> Floats:
    """The length of fairness at all places: the root of twice the area of the facet, or half the girth if less."""
    slope = girth(triangulation).slope
    slopes = np.concatenate([slope, slope[triangulation.polyhedron.triangles].mean(axis=1)])
    facet = at_samples(triangulation, refinement, np.sqrt(2 * area))
    with np.errstate(divide="ignore"):
        return np.asarray(np.minimum(facet, _OF_GIRTH / slopes))


def at_samples(triangulation: Triangulation, refinement: Bisection, of_facet: Floats) -> Floats:
    """A quantity of the facets at all places: at a vertex the mean over its fine triangles."""
    mesh = triangulation.polyhedron
    fine = refinement.spread(np.repeat(of_facet, 3).reshape(-1, 3, 1))[:, 0, 0]
    degree = np.maximum(np.bincount(mesh.tail, minlength=len(mesh.vertices)), 1)
    return np.concatenate([around_vertices(mesh, fine) / degree, fine])


def around_vertices(mesh: Polyhedron, of_face: Floats) -> Floats:
    """The sum of a quantity of triangles over those about each vertex."""
    return np.asarray(np.bincount(mesh.tail, weights=np.repeat(of_face, 3), minlength=len(mesh.vertices)), dtype=float)
