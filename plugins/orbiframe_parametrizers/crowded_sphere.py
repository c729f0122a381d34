"""Crowded spheres: a map to S^2 in patches, each near the origin of its frame, where one patch has not the digits.

A point of S^2 is a line in C^2, spanned by a spinor s = (z, 1); neighbours i, j differ by s_i1 s_j2 - s_i2 s_j1, which
is the difference z_i - z_j but for factors, before and after any Moebius map. So the isometry from one to the next has
all its digits, however near they are, and an atlas is made of them as in H^2.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import Geometry, Polyhedron, Triangulation, surface_type
from orbiframe.meshes import dijkstra_forest, edge_graph, farthest_points
from orbiframe_parametrizers.developing import in_patches, on_both_halfedges
from orbiframe_parametrizers.moebius import Centred
from orbiframe_parametrizers.plane_layout import Layout

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

_PATCH_RADIUS = 0.8
_PROBES = 40


def medoid_face(mesh: Polyhedron) -> int:
    """The face in the middle: with the least sum of distances to all of the surface, along edges.

    All of the surface stands for 40 vertices far from one another, each with the part that is nearest to it. Seen from
    there no limb is crowded more than it must be: on a limb that is most of the surface both its halves are alike.
    """
    graph = edge_graph(mesh)
    spacing = farthest_points(graph, _PROBES)
    corners = mesh.vertices[mesh.triangles]
    double = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    share = np.bincount(spacing.owner[mesh.tail], weights=np.repeat(double, 3), minlength=len(spacing.chosen))
    total = np.zeros(len(mesh.vertices))
    for probe, part in zip(spacing.chosen, share, strict=True):
        total += part * dijkstra_forest(graph, [probe]).distance
    return int(np.argmin(total[mesh.triangles].sum(axis=1)))


def patched_sphere(mesh: Polyhedron, geometry: Geometry, layout: Layout, centred: Centred) -> Triangulation:
    """The map to S^2 of a layout in the plane, centred by a Moebius map, in patches that shrink with its scale."""
    edges = np.flatnonzero(mesh.representative)
    spinors = np.stack([layout.z, np.ones_like(layout.z)], axis=1) @ centred.matrix.T
    size = np.linalg.norm(spinors, axis=1)
    spinors /= size[:, None]
    tail, head = mesh.tail[edges], mesh.head[edges]
    away = layout.differences[edges] * centred.determinant / size[tail] / size[head]
    along = np.einsum("ei,ei->e", spinors[tail].conj(), spinors[head])
    steps = on_both_halfedges(mesh, geometry, edges, _rotations(along, away))
    lengths = geometry.distance(geometry.origin, steps[..., 0])
    surface = surface_type(mesh)
    made = in_patches(mesh, geometry, lengths, steps, surface=surface, patch_radius=_PATCH_RADIUS)
    return replace(made, group="trivial")


def _rotations(a: Complexes, b: Complexes) -> Floats:
    """The rotations (E, 3, 3) of S^2 that w -> (conj(a) w + b) / (a - conj(b) w) is, for w = (x1 + i x2) / (1 + x0)."""
    length = np.hypot(np.abs(a), np.abs(b))
    a, b = a / length, b / length
    top = np.stack([np.abs(a) ** 2 - np.abs(b) ** 2, -2 * (a * b).real, -2 * (a * b).imag], axis=-1)
    side = np.stack([2 * b * a.conj(), a.conj() ** 2 - b**2, 1j * (a.conj() ** 2 + b**2)], axis=-1)
    return np.stack([top, side.real, side.imag], axis=-2)
