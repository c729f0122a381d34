"""Told by ends: meshes whose edges a file can tell, which holds faces as lists of vertices and no twins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from orbiframe.errors import TopologyError
from orbiframe.meshes.bisection import bisected
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.subdivision import Refinement, refine
from orbiframe.meshes.surface_type import SurfaceType, surface_type


def as_in_a_file(polyhedron: Polyhedron) -> Polyhedron:
    """The same faces with the twins that their vertices tell."""
    return Polyhedron.from_corners(polyhedron.vertices, polyhedron.offsets, polyhedron.tail)


def require_told_by_ends(polyhedron: Polyhedron, expected: SurfaceType) -> None:
    """Raise TopologyError unless the faces of a mesh, by their vertices alone, are the surface that is expected."""
    found = surface_type(as_in_a_file(polyhedron))
    if found != expected:
        raise TopologyError(
            f"the mesh that was made is in a file {_named(found)}, but {_named(expected)} is required, so nothing is "
            "written; please report it"
        )


def refined_by_ends(polyhedron: Polyhedron, density: int) -> Refinement:
    """`refine` for a closed mesh, with edges that their ends tell.

    Where several edges have the same ends, or two triangles all three corners, the triangles are halved until that is
    no more, and each half is refined.
    """
    plain = refine(polyhedron, density)
    if np.array_equal(as_in_a_file(plain.polyhedron).twin, plain.polyhedron.twin):
        return plain
    # Two triangles on the same corners are the one mesh without double edges that still is no simplicial complex.
    longest = np.inf if polyhedron.face_count > 2 else 0.99 * float(polyhedron.edge_lengths.max())
    halved = bisected(polyhedron, longest, simplicial=True)
    fine = refine(halved.polyhedron, density)
    whole = np.concatenate([np.tile(np.eye(3), (polyhedron.face_count, 1, 1)), _own_numbers(polyhedron)], axis=2)
    parts = halved.spread(whole)
    place = np.einsum("nc,nck->nk", fine.barycentric, parts[fine.face])
    owner, origin = (np.rint(number).astype(np.intp) for number in (place[:, 3], parts[fine.origin, 0, 3]))
    return replace(fine, coarse=polyhedron, face=owner, barycentric=place[:, :3], origin=origin)


def _own_numbers(polyhedron: Polyhedron) -> np.ndarray:
    return np.repeat(np.arange(polyhedron.face_count, dtype=np.float64), 3).reshape(-1, 3, 1)


def _named(surface: SurfaceType) -> str:
    return f"{surface.name} (Euler characteristic {surface.euler_characteristic})"
