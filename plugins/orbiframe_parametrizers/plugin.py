"""Parametrizers: maps from a triangle mesh to X/H, and an optimizer of the shapes in them."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl

_WEIGHTS = (
    "{name}: cotangent, mixed (mean values about the folds), mean-value, uniform, or auto, the first of these "
    "without a fold"
)
_EVEN_AREAS = "rounds that pull areas in X towards those in space, at the cost of angles"


@hookimpl
def orbiframe_components() -> list[Component]:
    """Harmonic maps for chi <= 0, to the group of the mesh or to a named one, and the packed sphere for chi > 0."""
    return [
        Component(
            "parametrizer",
            "harmonic",
            "orbiframe_parametrizers.harmonic:harmonic",
            "chi <= 0: group from a conformal metric or a circle packing, harmonic map in the atlas",
            meanings={
                "metric": "χ < 0: the metric that gives the group; vertex-scaling is conformal to the mesh, "
                "circle-packing exists for every mesh; auto scales, and packs where that fails or "
                "leaves a median angle distortion above 1.2",
                "weights": _WEIGHTS.format(name="harmonic"),
                "even_areas": _EVEN_AREAS,
            },
        ),
        Component(
            "parametrizer",
            "equivariant",
            "orbiframe_parametrizers.equivariant:equivariant",
            "chi <= 0: harmonic map to a named group, from the centre of its polygon",
            meanings={"weights": _WEIGHTS.format(name="equivariant"), "even_areas": _EVEN_AREAS},
        ),
        Component(
            "parametrizer",
            "sphere",
            "orbiframe_parametrizers.sphere:sphere",
            "chi > 0: packed or harmonic sphere, centred by a Moebius map",
            meanings={
                "weights": "sphere: cotangent, mean-value, packing, or auto, the one of these without a fold that "
                "distorts angles least"
            },
        ),
        Component(
            "optimizer",
            "regular-faces",
            "orbiframe_parametrizers.regular_faces:regular_faces",
            "faces in X/H as regular as possible, squares from quadrilaterals, by Newton on a shape energy",
            meanings={
                "group": "auto looks for a group that suits regular faces, where that of the map comes from the "
                "mesh and χ ≤ 0; kept never does",
                "area": "how much equal areas count against shape",
            },
        ),
        Component(
            "solver",
            "metis",
            "orbiframe_parametrizers.metis:metis",
            "nested dissection by METIS, factors by SuperLU",
        ),
        Component(
            "solver",
            "pardiso",
            "orbiframe_parametrizers.pardiso:pardiso",
            "Intel's Pardiso, on x86-64",
            extra="orbiframe[pardiso]",
        ),
    ]


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """A map to a named group; the others are what a fit does by itself."""
    return [
        "fit double_torus.off -o out.ply --quiet --group regular-polygon",
    ]
