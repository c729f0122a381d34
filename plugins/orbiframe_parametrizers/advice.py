"""Advice: why a mesh has no map, and what to do about it."""

from __future__ import annotations

from orbiframe import Polyhedron, Triangulation
from orbiframe.meshes import doubled_edges
from orbiframe.triangulations import crowding_of

_CROWDED = 9.0


def advice(mesh: Polyhedron, *attempts: Triangulation) -> str:
    """The next step where no map was found; attempts: maps with folds, which tell whether digits have run out."""
    doubled = int((doubled_edges(mesh) & mesh.representative).sum())
    if doubled:
        return (
            f"{doubled} edges are loops or share both ends with another edge, which two geodesics need not do; halve "
            "them with bisected(mesh, inf, simplicial=True), as a fit does by itself"
        )
    lost = max((crowding_of(attempt).digits_lost for attempt in attempts), default=0.0)
    if lost >= _CROWDED:
        return (
            f"long thin parts of the mesh are crowded into so little of X/H that {min(lost, 16):.0f} of 16 digits are "
            "lost there; shorten them or cut them off"
        )
    return "look for needle-like triangles with `orbiframe info`, remove them or refine the mesh"
