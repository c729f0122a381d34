"""The formats of Open3D that neither the polygon formats nor meshio cover."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl

EXTRA = "orbiframe[open3d]"
SUFFIXES = (".fbx",)


@hookimpl
def orbiframe_components() -> list[Component]:
    """One reader and one writer; as `format` they serve every suffix that Open3D knows."""
    return [
        Component(
            "reader",
            "open3d",
            "orbiframe_open3d.reader:read",
            "FBX, triangles",
            EXTRA,
            SUFFIXES,
            meanings={"seconds": "the time that a file may take"},
        ),
        Component("writer", "open3d", "orbiframe_open3d.writer:write", "FBX, triangles", EXTRA, SUFFIXES),
    ]
