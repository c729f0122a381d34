"""Polyhedra as NumPy archives."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """A reader and a writer of .npz."""
    summary = "NumPy archive: polygons, normals, colours, all digits kept"
    return [
        Component("reader", "npz", "orbiframe_example_npz.reader:read", summary, suffixes=(".npz",)),
        Component("writer", "npz", "orbiframe_example_npz.writer:write", summary, suffixes=(".npz",)),
    ]
