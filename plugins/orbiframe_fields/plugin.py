"""Fields on surfaces: curvature of meshes, and functions from data."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The commands that measure curvature and that fit functions."""
    return [
        Component(
            "command",
            "curvature",
            "orbiframe_fields.curvature_command:configure",
            "principal curvatures and directions at the vertices of a mesh",
        ),
        Component(
            "command",
            "field",
            "orbiframe_fields.field_command:configure",
            "smooth functions on the surface of a mesh from values at points",
        ),
        Component(
            "command",
            "spectrum",
            "orbiframe_fields.spectrum_command:configure",
            "eigenvalues and eigenfunctions of the surface of a mesh, and signatures",
        ),
        Component(
            "command",
            "distance",
            "orbiframe_fields.distance_command:configure",
            "geodesic distance along the surface of a mesh",
        ),
    ]


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """Curvature of a surface of the functions that the command takes, and distances along one."""
    return [
        "curvature torus.off -o curvature.csv",
        "distance torus.off --from 0 --set basis.size=200 -o distance.csv",
    ]
