"""Polygon formats: OFF, OBJ, PLY and STL, with faces of any size."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl

FORMATS = {
    "off": "Object File Format: polygons, normals, colours of vertices and faces",
    "obj": "Wavefront OBJ: polygons, normals, colours of vertices",
    "ply": "Polygon File Format, text or binary: polygons, normals, colours of vertices and faces",
    "stl": "stereolithography, text or binary: triangles; equal corners become one vertex",
}


@hookimpl
def orbiframe_components() -> list[Component]:
    """A reader and a writer for each of the four formats."""
    return [
        Component(kind, name, f"orbiframe_polygons.{name}_{kind}:{verb}", summary, suffixes=(f".{name}",))
        for name, summary in FORMATS.items()
        for kind, verb in (("reader", "read"), ("writer", "write"))
    ]
