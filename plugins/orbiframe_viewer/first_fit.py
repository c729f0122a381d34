"""First fit: the surface with which an edit begins, and the configuration that all further ones have."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from orbiframe import Config, OrbifoldSurface, Polyhedron, Registry, UsageError
from orbiframe.fitting import fit_parts, tables_of
from orbiframe_viewer.draft import Draft
from orbiframe_viewer.edit_scene import Display
from orbiframe_viewer.edited_fit import EditedFit, Progress, shown_fit


def first_fit(
    mesh: Polyhedron, surface: OrbifoldSurface | None, base: Config, registry: Registry, progress: Progress
) -> tuple[Config, EditedFit]:
    """The configuration with the functions as they were found, and the fit.

    surface: whose map and functions are taken, where one was saved. Raises UsageError for a mesh of several components.
    """
    if surface is not None:
        basis = {"name": surface.basis_name, **_given(surface.basis_options)}
        tables = tables_of(base)
        base = replace(Config.from_tables(tables | {"basis": basis}), plugins=base.plugins)
    moved, base = base.output.moved, replace(base, output=replace(base.output, moved=()))
    parts = fit_parts(mesh, base, registry, progress, like=surface)
    if len(parts.results) > 1:
        raise UsageError(
            f"the mesh has {len(parts.results)} components, and one is edited at a time; choose one with --component N"
        )
    result = parts.results[0]
    fitted, tables = result.surface, tables_of(base)
    draft = Draft(
        result.input.vertices,
        moved,
        {"name": fitted.basis_name, **_given(fitted.basis_options)},
        tables["fitter"],
    )
    return base, shown_fit(draft, result, Display.of(fitted, result.input), registry)


def _given(options: Any) -> dict[str, Any]:
    return {name: value for name, value in options.items() if value is not None}
