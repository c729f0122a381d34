"""The formats of meshio that hold surfaces, beside those that have readers of their own."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl

# meshio knows more suffixes. Left out are those whose surfaces it cannot write and read again without loss, those
# whose library is not installed with it, archives, and what is seldom used for surfaces.
SUFFIXES = (
    ".msh",
    ".mesh",
    ".meshb",
    ".inp",
    ".avs",
    ".dat",
    ".tec",
    ".nas",
    ".bdf",
    ".fem",
    ".vol",
    ".post",
    ".dato",
    ".su2",
    ".ugrid",
)
# Those that have a reader of our own; meshio only writes them.
WRITTEN = (".msh", ".mesh", ".meshb", ".inp", ".dat", ".tec", ".nas", ".bdf", ".fem")
READ = tuple(suffix for suffix in SUFFIXES if suffix not in WRITTEN)


@hookimpl
def orbiframe_components() -> list[Component]:
    """One reader and one writer for all these formats; as `format` they serve every suffix that meshio knows."""
    return [
        Component(
            "reader",
            "meshio",
            "orbiframe_meshio.reader:read",
            "AVS-UCD, Netgen, Permas, SU2, UGRID",
            suffixes=READ,
            meanings={"seconds": "the time that a file may take"},
        ),
        Component(
            "writer",
            "meshio",
            "orbiframe_meshio.writer:write",
            "Gmsh, Medit, Abaqus, Nastran and others",
            suffixes=SUFFIXES,
        ),
    ]
