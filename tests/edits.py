"""Sessions of the editor without a browser."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from orbiframe_viewer.edit_session import EditSession
from orbiframe_viewer.edited_files import saver
from orbiframe_viewer.edited_fit import EditedFit
from orbiframe_viewer.first_fit import first_fit

from orbiframe import Config, Registry, read

DATASETS = Path(__file__).parents[1] / "datasets"
REGISTRY = Registry.discover()


def base_of(size: int, *overrides: str) -> Config:
    return Config.load(overrides=[f"basis.size={size}", *overrides])


@cache
def first(name: str, size: int, *overrides: str) -> EditedFit:
    """The first fit of a dataset."""
    mesh = read(DATASETS / f"{name}.off", REGISTRY)
    return first_fit(mesh, None, base_of(size, *overrides), REGISTRY, lambda *_: None)[1]


def session_of(found: EditedFit, path: Path, *overrides: str) -> EditSession:
    """A session that begins with a fit, and saves a mesh to `path`."""
    base = base_of(found.result.surface.basis.size, *overrides)
    mesh = found.result.input
    session = EditSession(path.name, base, REGISTRY, saver(path, mesh, base, REGISTRY))
    session.begin(mesh, found.draft, found)
    return session
