"""Parametrizers: maps from a triangle mesh to X/H."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The harmonic map for chi <= 0 and the packed sphere for chi > 0."""
    return [
        Component(
            "parametrizer",
            "harmonic",
            "orbiframe_parametrizers.harmonic:harmonic",
            "chi <= 0: group from a circle packing, harmonic map in the atlas",
        ),
        Component(
            "parametrizer",
            "sphere",
            "orbiframe_parametrizers.sphere:sphere",
            "chi > 0: packed or harmonic sphere, centred by a Moebius map",
        ),
    ]
