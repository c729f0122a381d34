"""Exact exchange of surfaces: rational patches for viewers and CAD systems."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """Rational Bezier triangles for VTK, and tensor product patches for Open CASCADE."""
    return [
        Component(
            "exporter",
            "bezier-vtu",
            "orbiframe_exact.bezier_vtu:write_bezier_vtu",
            "rational Bezier triangles, exact, for ParaView and VTK",
            suffixes=(".vtu",),
        ),
        Component(
            "exporter",
            "step",
            "orbiframe_exact.open_cascade:write_step",
            "exact rational patches sewn to a shell, for CAD systems",
            extra="orbiframe[cad]",
            suffixes=(".step", ".stp"),
        ),
        Component(
            "exporter",
            "iges",
            "orbiframe_exact.open_cascade:write_iges",
            "exact rational patches, for older CAD systems",
            extra="orbiframe[cad]",
            suffixes=(".iges", ".igs"),
        ),
        Component(
            "exporter",
            "gismo",
            "orbiframe_exact.gismo:write_gismo",
            "a few B-spline patches with their interfaces, for isogeometric analysis with G+Smo",
            suffixes=(".xml",),
        ),
    ]
