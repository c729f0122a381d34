"""One fit of a study, as a worker does it: the mesh is read, fitted, and what is wanted of it is kept in files."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from orbiframe import Config, FormatError, OrbiframeError, Polyhedron, Registry, read, write
from orbiframe.files import save_surface
from orbiframe.fitting import KeptMaps, Parts, fit_parts
from orbiframe.workers import peak_memory, reset_peak
from orbiframe_studies.arrays import write_arrays
from orbiframe_studies.machine import machine
from orbiframe_studies.plan import Fit
from orbiframe_studies.study_folder import StudyFolder

Tell = Callable[[str, float | None], None]
Entry = dict[str, Any]
_MEMORY = "it needs more memory than there is; it is tried again when the study is run again"


@dataclass(frozen=True, slots=True)
class Terms:
    """What all fits of a study have in common for a worker: the folder, noise, what is kept, maps too, memory in GB."""

    folder: Path
    noise: float | None
    keep: tuple[str, ...]
    maps: bool
    memory: float | None


def fit_task(registry: Registry, terms: Terms) -> Callable[[Fit, Tell], Entry]:
    """What a worker does for each fit; raises only what stops the whole study, as a disk that is full."""
    folder = StudyFolder(terms.folder)
    maps = KeptMaps(folder.maps if terms.maps else None)

    def task(fit: Fit, tell: Tell) -> Entry:
        _require_folder(folder)
        reset_peak()
        start, before = time.perf_counter(), (maps.computed, maps.kept)
        found = _attempted(fit, registry, terms, maps, tell)
        if "parts" in found:
            _keep(found.pop("parts"), fit, terms.keep, folder, registry)
        timing = {
            "seconds": found.pop("seconds", {}),
            "total": round(time.perf_counter() - start, 4),
            "peak": peak_memory(),
            "maps_computed": maps.computed - before[0],
            "maps_kept": maps.kept - before[1],
            "process": os.getpid(),
            "ended": datetime.now(UTC).isoformat(timespec="seconds"),
            **machine(),
        }
        return {"key": fit.key, **found, "timing": timing}

    return task


def _require_folder(folder: StudyFolder) -> None:
    if not folder.identity.exists():
        raise FormatError(
            f"{folder.path}: the worker on {machine()['host']} does not see the folder of the study; put it where all "
            "workers find it under the same name"
        )


def _attempted(fit: Fit, registry: Registry, terms: Terms, maps: KeptMaps, tell: Tell) -> Entry:
    """The report of a fit, or why there is none."""
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("ignore")
            warnings.filterwarnings("always", category=UserWarning)
            parts = _fitted(fit, registry, terms.noise, maps, tell)
    except MemoryError:
        return {"status": "lost", "error": {"type": "MemoryError", "text": _MEMORY}}
    except (OrbiframeError, Exception) as error:
        return {"status": "failed", "error": {"type": type(error).__name__, "text": str(error)}}
    report = {name: value for name, value in parts.report.items() if name not in ("seconds", "versions")}
    said = [str(each.message) for each in caught]
    found = {"status": "done", "error": None, "report": plain(report), "warnings": said}
    return {**found, "seconds": parts.report["seconds"], "parts": parts}


def _fitted(fit: Fit, registry: Registry, noise: float | None, maps: KeptMaps, tell: Tell) -> Parts:
    config = Config.from_tables(fit.tables)
    format = None if config.mesh.open else config.mesh.name
    polyhedron = read(fit.mesh, registry, format=format)
    if noise is not None and fit.seed is not None:
        polyhedron = noisy(polyhedron, noise, fit.seed)
    return fit_parts(polyhedron, config, registry, tell, maps=maps)


def noisy(polyhedron: Polyhedron, noise: float, seed: int) -> Polyhedron:
    """The polyhedron with normal noise on every coordinate of its vertices, relative to the diagonal of its box."""
    moves = np.random.default_rng(seed).normal(scale=noise * polyhedron.diagonal, size=polyhedron.vertices.shape)
    return polyhedron.with_vertices(polyhedron.vertices + moves)


def _keep(parts: Parts, fit: Fit, keep: tuple[str, ...], folder: StudyFolder, registry: Registry) -> None:
    """Write what is wanted of a fit; each file appears whole or not at all."""
    if not keep:
        return
    path = folder.kept(fit.key, "")
    path.parent.mkdir(parents=True, exist_ok=True)
    if "arrays" in keep:
        write_arrays(path.with_suffix(".h5"), parts)
    if "mesh" in keep:
        write(path.with_suffix(".ply"), parts.output, registry)
    if "surface" in keep:
        several = len(parts.results) > 1
        for number, result in enumerate(parts.results, start=1):
            save_surface(result.surface, path.with_name(f"{path.name}{f'-{number}' if several else ''}.npz"))


def plain(value: Any) -> Any:
    """Data that JSON can hold: numbers that are not finite become None."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    return None if isinstance(value, float) and not np.isfinite(value) else value
