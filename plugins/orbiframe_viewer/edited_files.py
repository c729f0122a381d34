"""Edited files: the mesh, the surface, and the configuration by which `orbiframe fit` makes it again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from orbiframe import Config, Polyhedron, Registry, save_surface, write
from orbiframe.files import write_text
from orbiframe.fitting import config_toml, tables_of
from orbiframe_viewer.draft import Draft
from orbiframe_viewer.edited_fit import EditedFit

SURFACE, CONFIG = ".npz", ".toml"
# The tables that say how a map is made, of no use where one is taken over.
_OF_MAPS = ("geometry", "group", "marking", "map", "shape")


def files_beside(mesh: Path) -> tuple[Path, Path]:
    """The files of the surface and of the configuration that go with a mesh."""
    return mesh.with_suffix(SURFACE), mesh.with_suffix(CONFIG)


def saver(path: Path, mesh: Polyhedron, base: Config, registry: Registry) -> Callable[[EditedFit], list[Path]]:
    """What writes a fit: the mesh to `path`, the surface and the configuration beside it."""

    def save(found: EditedFit) -> list[Path]:
        surface, config = files_beside(path)
        write(path, mesh.with_vertices(found.draft.vertices), registry)
        save_surface(found.surface, surface)
        write_text(config, fit_text(found, base, path))
        return [path, surface, config]

    return save


def save_draft(path: Path, mesh: Polyhedron, draft: Draft, base: Config, registry: Registry) -> list[Path]:
    """Write a draft that is not fitted: the mesh and the configuration."""
    config = path.with_suffix(CONFIG)
    write(path, mesh.with_vertices(draft.vertices), registry)
    write_text(config, _command(path) + config_toml(_moved(draft.config(base, None), draft)))
    return [path, config]


def fit_text(found: EditedFit, base: Config, path: Path) -> str:
    """The configuration that makes the surface of a fit again, from the mesh at `path` and the map that was used."""
    means = found.result.report["data"]["means"]
    config = _moved(found.draft.config(base, means), found.draft)
    if not found.owns_map:
        tables: dict[str, Mapping[str, Any]] = {k: v for k, v in tables_of(config).items() if k not in _OF_MAPS}
        taken = Config.from_tables(tables | {"map": {"like": path.with_suffix(SURFACE).name}})
        config = replace(taken, plugins=config.plugins)
    return _command(path) + config_toml(config)


def _moved(config: Config, draft: Draft) -> Config:
    return replace(config, output=replace(config.output, moved=draft.moved))


def _command(path: Path) -> str:
    return f"# orbiframe fit {path.name} --config {path.with_suffix(CONFIG).name} -o surface.ply\n\n"
