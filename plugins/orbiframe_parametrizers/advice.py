"""Advice: why a mesh has no map, and what to do about it."""

from __future__ import annotations

import numpy as np

from orbiframe import Polyhedron, Triangulation
from orbiframe.meshes import doubled_edges

CROWDED = 13.0  # so many digits lost leave too few for a fit; fewer do not show in its error
_NEEDLE = 1e-4


def advice(mesh: Polyhedron, *attempts: Triangulation, digits: float = 0.0) -> str:
    """What is wrong where no map was found, and the next step.

    attempts: maps with folds; digits: between the largest and the smallest scale of a map, where it is known otherwise.
    """
    doubled = int((doubled_edges(mesh) & mesh.representative).sum())
    if doubled:
        return (
            f"{doubled} edges are loops or share both ends with another edge, which two geodesics need not do; halve "
            "them with bisected(mesh, inf, simplicial=True), as a fit does by itself"
        )
    needles = _needles(mesh)
    if needles:
        return (
            f"{needles} of {mesh.face_count} triangles are needles, whose height is less than 1/10000 of their longest "
            "side; see `orbiframe info`, and remove them or refine the mesh"
        )
    digits = max([digits, *(_spanned(attempt) for attempt in attempts)])
    if digits >= CROWDED:
        return (
            "long thin parts of the mesh are crowded into so little of X/H that it takes "
            f"{digits:.0f} digits to tell their places, and a number has 16; shorten them or cut them off"
        )
    if not attempts:
        return "refine the mesh where its triangles are large or their angles are"
    least = min(attempts, key=lambda attempt: attempt.not_positive)
    return (
        f"{least.not_positive} of {mesh.face_count} triangles are folded in the best attempt, though none is a needle "
        "and none is crowded; refine the mesh where its angles are large"
    )


def _spanned(attempt: Triangulation) -> float:
    """The digits between the small and the large scales of a map, length in X per length in space, but for a few."""
    mesh, lifts = attempt.polyhedron, attempt.lifts
    in_x = attempt.orbifold.geometry.distance(lifts, np.roll(lifts, -1, axis=1)).ravel()
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = np.log10(in_x / mesh.edge_lengths)
    known = scale[np.isfinite(scale)]
    return float(np.ptp(np.quantile(known, [0.02, 0.98]))) if len(known) else 0.0


def _needles(mesh: Polyhedron) -> int:
    """How many triangles are so thin that their angles say nothing."""
    corners = mesh.vertices[mesh.triangles]
    double = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return int((double < _NEEDLE * mesh.edge_lengths.reshape(-1, 3).max(axis=1) ** 2).sum())
