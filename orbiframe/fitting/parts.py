"""Parts: a file of several closed surfaces, each fitted with its share of the functions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.registry import Registry
from orbiframe.errors import UsageError
from orbiframe.fitting.config import Config
from orbiframe.fitting.given_back import GivenBack
from orbiframe.fitting.kept_maps import KeptMaps
from orbiframe.fitting.pipeline import Result, fit, mesh_of, registry_for
from orbiframe.fitting.report import versions
from orbiframe.fitting.settings import configured
from orbiframe.fitting.stages import Progress
from orbiframe.fitting.told import told
from orbiframe.meshes.defects import require_closed_surface
from orbiframe.meshes.orientation import face_components
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.repair import component
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.unions import disjoint_union
from orbiframe.surfaces.surface import OrbifoldSurface

Floats = NDArray[np.float64]
Like = OrbifoldSurface | str | Path | None

# A closed surface of any shape needs some functions, however small it is.
_LEAST = 100


@dataclass(frozen=True, eq=False, repr=False)
class Parts(GivenBack):
    """What a fit of several surfaces returns: a result for each, one mesh of all, and one report."""

    results: tuple[Result, ...]
    output: Polyhedron
    report: dict[str, Any]


def fit_parts(
    mesh: object,
    config: Config | None = None,
    registry: Registry | None = None,
    progress: Progress | Literal[False] | None = None,
    *,
    maps: KeptMaps | None = None,
    like: Like = None,
    **settings: Any,
) -> Parts:
    """The smooth surfaces of all components of a polyhedron, that with the most faces first.

    A number of functions that is asked for is shared out by area, 100 at least to each; else each has as many as its
    shape needs. A tolerance is relative to the bounding box of all. One component gives the report of `fit`; several
    give one with "parts", the report of each, and with the errors, relative to the box of all, and the sizes of all
    together. See `fit` for the rest.
    """
    config = configured(config, settings)
    registry = registry_for(config) if registry is None else registry
    with told(progress) as heard:
        return _fitted(mesh, config.checked(registry), registry, heard, maps, like)


def _fitted(
    mesh: object, config: Config, registry: Registry, progress: Progress, maps: KeptMaps | None, like: Like
) -> Parts:
    whole = mesh_of(mesh, config, registry)
    require_closed_surface(whole, several=True, boundary=config.boundary != "error")
    count = face_components(whole)[0]
    if count == 1:
        only = fit(whole, config, registry, progress, maps=maps, like=like)
        return Parts((only,), only.output, only.report)
    if like is not None or config.like is not None or config.output.moved or config.data.fixed:
        raise UsageError(
            f"the mesh has {count} components, and a map that is taken over (--like, map.like), coefficients that are "
            "moved (output.moved) and fixed points (data.fixed) are those of one; choose one with --component N"
        )
    pieces = [component(whole, number).polyhedron for number in range(1, count + 1)]
    areas = np.array([np.linalg.norm(vector_areas(piece), axis=1).sum() for piece in pieces])
    shares = areas / areas.sum()
    results = []
    for number, (piece, share) in enumerate(zip(pieces, shares, strict=True), start=1):
        own = _own_config(config, float(share), whole.diagonal / (piece.diagonal or 1.0))
        results.append(fit(piece, own, registry, _numbered(progress, number, count), share=float(share), maps=maps))
    output = disjoint_union([result.output for result in results])
    return Parts(tuple(results), output, _report(results, areas, whole.diagonal, output))


def _own_config(config: Config, share: float, enlarged: float) -> Config:
    """The configuration of a part: its share of the functions asked for, and tolerances relative to its own box."""
    size = config.basis.options.get("size")
    if size is not None:
        config = config.with_options("basis", size=max(_LEAST, round(size * share)))
    output = config.output
    tolerance, largest = (None if value is None else value * enlarged for value in (output.tolerance, output.max_error))
    return replace(config, output=replace(output, tolerance=tolerance, max_error=largest))


def _numbered(progress: Progress, number: int, count: int) -> Progress:
    return lambda stage, seconds: progress(f"{stage} {number}/{count}", seconds)


def _report(results: list[Result], areas: Floats, diagonal: float, output: Polyhedron) -> dict[str, Any]:
    """The report of each part, and of all: errors relative to the box of all, sizes and seconds together."""
    parts = [result.report for result in results]
    scale = np.array([result.surface.scale for result in results]) / diagonal
    rms, largest = (np.array([part["fit"][key] for part in parts]) * scale for key in ("rms", "max"))
    seconds: dict[str, float] = {}
    for part in parts:
        for stage, spent in part["seconds"].items():
            seconds[stage] = round(seconds.get(stage, 0.0) + spent, 4)
    return {
        "parts": parts,
        "fit": {
            "size": sum(part["fit"]["size"] for part in parts),
            "samples": sum(part["fit"]["samples"] for part in parts),
            "rms": float(np.sqrt(areas @ rms**2 / areas.sum())),
            "max": float(largest.max()),
        },
        "output": {
            "vertices": len(output.vertices),
            "faces": output.face_count,
            "euler_characteristic": len(output.vertices) - output.edge_count + output.face_count,
        },
        "seconds": seconds,
        "versions": versions(),
    }
