"""Embedding: the harmonic map in a given atlas, with the first of several edge weights that makes no fold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import MapError, Triangulation
from orbiframe.triangulations import crowding_of
from orbiframe_parametrizers.advice import CROWDED, advice
from orbiframe_parametrizers.developing import with_patch_radii
from orbiframe_parametrizers.edge_weights import WEIGHTS, cotangent, mean_value
from orbiframe_parametrizers.harmonic_energy import minimised

Floats = NDArray[np.float64]
Finish = Callable[[Triangulation, Floats], Triangulation]

_ROUNDS = 4


def embedded(layout: Triangulation, choice: str, finish: Finish = lambda result, _: result) -> Triangulation:
    """The harmonic map without a fold, from a first guess.

    layout: the atlas and the first guess; choice: "cotangent", "mixed" (mean values about the folds, cotangents
    elsewhere), "mean-value", "uniform", or "auto", the first of these that makes no fold; finish: what is done to every
    harmonic map with its weights (H,). Where a harmonic map has lost 13 digits or more to crowding, or where none is an
    embedding, "auto" leaves the first guess as it is, if that has no fold. Raises MapError where nothing has none.
    """
    names = ["cotangent", "mixed", "mean-value", "uniform"] if choice == "auto" else [choice]
    attempt, first, crowded = layout, layout, None
    for name in names:
        if name == "mixed":
            result = _mixed(layout, finish)
        else:
            result = _mapped(layout, name, WEIGHTS[name](layout.polyhedron), finish)
        if result is None:
            continue
        if result.not_positive == 0:
            if choice != "auto" or crowding_of(result).digits_lost < CROWDED:
                return result
            crowded = crowded or result
        attempt = result
        layout = result if name == "cotangent" else layout  # a better first guess than the layout
    if choice == "auto" and first.not_positive == 0:
        return with_patch_radii(replace(finish(first, mean_value(first.polyhedron)), weights="first guess"))
    if crowded is not None:
        return crowded
    raise MapError(
        f"no map without a fold was found with {' or '.join(names)} weights; "
        + (advice(layout.polyhedron, attempt) if choice == "auto" else "use map.weights = 'auto'")
    )


def _mapped(layout: Triangulation, name: str, weights: Floats, finish: Finish) -> Triangulation | None:
    """The harmonic map with given weights from a first guess; None where there is none. It may have folds."""
    if not np.isfinite(weights).all():
        return None
    try:
        points = minimised(layout, weights)
    except MapError:
        return None
    return with_patch_radii(finish(replace(layout, points=points, weights=name), weights))


def _mixed(layout: Triangulation, finish: Finish) -> Triangulation | None:
    """Cotangents, but mean values on the edges about every fold; the region grows until no fold is left."""
    mesh = layout.polyhedron
    soft, firm = cotangent(mesh), mean_value(mesh)
    if not (np.isfinite(soft).all() and np.isfinite(firm).all()):
        return None
    # Mean values have the dimension 1 / length; on equilateral triangles both are now the same.
    firm = firm * mesh.edge_lengths.mean() / 2
    result = _mapped(layout, "mixed", soft, finish)
    near = np.zeros(len(mesh.vertices), dtype=np.bool_)
    for round_ in range(_ROUNDS):
        if result is None or result.not_positive == 0:
            return result
        near[mesh.triangles[~(result.areas > 0)]] = True
        for _ in range(1 + round_):
            near[mesh.triangles[near[mesh.triangles].any(axis=1)]] = True
        weights = np.where(near[mesh.tail] | near[mesh.head], firm, soft)
        result = _mapped(replace(layout, points=result.points), "mixed", weights, finish)
    return result
