"""Curved elements: Lagrange triangles of orders 1 to 6 for finite elements."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """Formats of curved triangles; the older one of Gmsh is asked for by its name."""
    return [
        Component(
            "elements",
            "gmsh",
            "orbiframe_lagrange.gmsh:write",
            "Gmsh 4.1: triangles of types 2, 9, 21, 23, 25 and 42",
            suffixes=(".msh",),
        ),
        Component(
            "elements",
            "gmsh-2.2",
            "orbiframe_lagrange.gmsh:write_2_2",
            "Gmsh 2.2, which more programs read",
            suffixes=(".msh2",),
        ),
        Component(
            "elements",
            "lagrange-vtu",
            "orbiframe_lagrange.vtu:write",
            "VTK_LAGRANGE_TRIANGLE, for ParaView and VTK",
            suffixes=(".vtu",),
        ),
        Component(
            "elements",
            "mfem",
            "orbiframe_lagrange.mfem:write",
            "MFEM mesh v1.0 with curved nodes",
            suffixes=(".mesh",),
        ),
    ]
