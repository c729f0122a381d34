"""Formats that are read and written here, without a library: polygons, scenes and the meshes of other programs."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl

FORMATS = {
    "off": ("off", "Object File Format: polygons, normals, colours of vertices and faces", (".off",)),
    "obj": ("obj", "Wavefront OBJ: polygons, normals, colours of vertices", (".obj",)),
    "ply": ("ply", "Polygon File Format, text or binary: polygons, normals, colours of vertices and faces", (".ply",)),
    "stl": ("stl", "stereolithography, text or binary: triangles; equal corners become one vertex", (".stl",)),
    "xdmf": ("xdmf", "XDMF with the numbers in the file itself: polygons", (".xdmf", ".xmf")),
    "3mf": ("threemf", "3D Manufacturing Format: triangles", (".3mf",)),
    "gltf": ("gltf.", "glTF 2.0, binary or text: triangles, normals, colours of vertices", (".glb", ".gltf")),
    "vtk": ("vtk.", "VTK, legacy and XML: polygons", (".vtk", ".vtp", ".vtu")),
}

# Formats that are read here, by readers without writers beside them: module, summary, suffixes.
READ_ONLY = {
    "collada": ("collada.reader", "COLLADA: polygons, each mesh at its places", (".dae",)),
    "abaqus": ("elements.abaqus_reader", "Abaqus input: shells, parts at their instances", (".inp",)),
    "nastran": ("elements.nastran_reader", "Nastran bulk data: shells", (".nas", ".bdf", ".fem")),
    "gmsh": ("elements.gmsh_reader", "Gmsh, versions 1 to 4.1: triangles and quads", (".msh",)),
    "medit": ("elements.medit_reader", "Medit, text and binary: triangles and quads", (".mesh", ".meshb")),
    "tecplot": ("elements.tecplot_reader", "Tecplot, text: triangles and quads", (".dat", ".tec")),
}


@hookimpl
def orbiframe_components() -> list[Component]:
    """A reader for each of these formats, and a writer for most."""
    return (
        [
            Component(
                kind,
                name,
                f"orbiframe_polygons.{_module(module, kind)}:{verb}",
                summary,
                suffixes=suffixes,
                welds=name == "stl",
                textures=kind == "writer" and name in ("obj", "gltf"),
                marks=kind == "writer" and name in ("obj", "ply"),
            )
            for name, (module, summary, suffixes) in FORMATS.items()
            for kind, verb in (("reader", "read"), ("writer", "write"))
        ]
        + [
            Component("reader", name, f"orbiframe_polygons.{module}:read", summary, suffixes=suffixes)
            for name, (module, summary, suffixes) in READ_ONLY.items()
        ]
        + [
            Component(
                "reader",
                name,
                f"orbiframe_polygons.packed_reader:read_{name}",
                f"one mesh in a .{name}",
                suffixes=(f".{name}",),
            )
            for name in ("gz", "zip")
        ]
    )


def _module(module: str, kind: str) -> str:
    """The module of a reader or writer: off_reader, or reader in a folder of its own."""
    return f"{module}{kind}" if module.endswith(".") else f"{module}_{kind}"


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """Large texts, read and written."""
    return [
        "convert large.off large.obj",
        "info large.obj",
        "convert large.off large.stl",
        "info large.stl",
    ]
