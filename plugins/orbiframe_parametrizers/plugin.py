"""Parametrizers: maps from a triangle mesh to X/H, and an optimizer of the shapes in them."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """Harmonic maps for chi <= 0, to the group of the mesh or to a named one, and the packed sphere for chi > 0."""
    return [
        Component(
            "parametrizer",
            "harmonic",
            "orbiframe_parametrizers.harmonic:harmonic",
            "chi <= 0: group from a conformal metric or a circle packing, harmonic map in the atlas",
        ),
        Component(
            "parametrizer",
            "equivariant",
            "orbiframe_parametrizers.equivariant:equivariant",
            "chi <= 0: harmonic map to a named group, from the centre of its polygon",
        ),
        Component(
            "parametrizer",
            "sphere",
            "orbiframe_parametrizers.sphere:sphere",
            "chi > 0: packed or harmonic sphere, centred by a Moebius map",
        ),
        Component(
            "optimizer",
            "regular-faces",
            "orbiframe_parametrizers.regular_faces:regular_faces",
            "faces in X/H as regular as possible, squares from quadrilaterals, by Newton on a shape energy",
        ),
    ]


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """A map to a named group; the others are what a fit does by itself."""
    return [
        "fit double_torus.off -o out.ply --quiet --group regular-polygon",
    ]
