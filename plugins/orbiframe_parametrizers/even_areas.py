"""Even areas: harmonic maps with weights that pull the triangles in X towards the areas they have in space."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import MapError, Polyhedron, Triangulation
from orbiframe_parametrizers.developing import with_patch_radii
from orbiframe_parametrizers.edge_weights import WEIGHTS
from orbiframe_parametrizers.harmonic_energy import minimised

Floats = NDArray[np.float64]

_POWER = 0.5


def evened(made: Triangulation, rounds: int) -> Triangulation:
    """The harmonic map after so many rounds of w_ij <- w_ij (a_i a_j)^(1/4), in the same group.

    a: the ratio of the area about a vertex in X to that in space, over its mean (Yoshizawa, Belyaev, Seidel 2004).
    Large places get firmer edges and shrink. Weights stay positive, which keeps every round an embedding; a map of
    cotangents of which some are not positive goes on with mean values. A round that fails in rounding is the last.
    """
    if rounds == 0:
        return made
    mesh = made.polyhedron
    name, weights = _positive_weights(mesh, made.weights)
    area = np.linalg.norm(_double_areas(mesh), axis=1)
    result = made
    for count in range(1, rounds + 1):
        growth = _at_vertices(mesh, result.areas) / np.maximum(_at_vertices(mesh, area), np.finfo(float).tiny)
        factor = (growth / growth.mean()) ** (_POWER / 2)
        weights = weights * factor[mesh.tail] * factor[mesh.head]
        try:
            points = minimised(result, weights / weights.mean())
        except MapError:
            break
        further = with_patch_radii(replace(result, points=points, weights=f"{name}, {count} rounds of even areas"))
        if further.not_positive:
            break
        result = further
    return result


def _positive_weights(mesh: Polyhedron, name: str) -> tuple[str, Floats]:
    """The weights of the name where all are positive, else mean values, else ones, with their name."""
    for choice in (name, "mean-value"):
        weights = WEIGHTS[choice](mesh) if choice in WEIGHTS else np.array([np.nan])
        if np.isfinite(weights).all() and (weights > 0).all():
            return choice, weights
    return "uniform", WEIGHTS["uniform"](mesh)


def _double_areas(mesh: Polyhedron) -> Floats:
    corners = mesh.vertices[mesh.triangles]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _at_vertices(mesh: Polyhedron, areas: Floats) -> Floats:
    """The sum of areas (F,) about every vertex, (V,)."""
    sums = np.bincount(mesh.tail, weights=np.repeat(areas, 3), minlength=len(mesh.vertices))
    return np.asarray(sums, dtype=np.float64)
