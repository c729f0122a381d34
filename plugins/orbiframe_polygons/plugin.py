"""Polygon formats: OFF, OBJ, PLY and XDMF with faces of any size, STL and 3MF with triangles."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl

FORMATS = {
    "off": ("off", "Object File Format: polygons, normals, colours of vertices and faces", (".off",)),
    "obj": ("obj", "Wavefront OBJ: polygons, normals, colours of vertices", (".obj",)),
    "ply": ("ply", "Polygon File Format, text or binary: polygons, normals, colours of vertices and faces", (".ply",)),
    "stl": ("stl", "stereolithography, text or binary: triangles; equal corners become one vertex", (".stl",)),
    "xdmf": ("xdmf", "XDMF with the numbers in the file itself: polygons", (".xdmf", ".xmf")),
    "3mf": ("threemf", "3D Manufacturing Format: triangles", (".3mf",)),
}


@hookimpl
def orbiframe_components() -> list[Component]:
    """A reader and a writer for each of these formats."""
    return [
        Component(
            kind, name, f"orbiframe_polygons.{module}_{kind}:{verb}", summary, suffixes=suffixes, welds=name == "stl"
        )
        for name, (module, summary, suffixes) in FORMATS.items()
        for kind, verb in (("reader", "read"), ("writer", "write"))
    ]


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """Large texts, read and written."""
    return [
        "convert large.off large.obj",
        "info large.obj",
        "convert large.off large.stl",
        "info large.stl",
    ]
