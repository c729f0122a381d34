"""Invariants of groups: geodesics, spectra, growth, exact proofs."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The command that describes a group."""
    return [
        Component(
            "command",
            "group",
            "orbiframe_invariants.group_command:configure",
            "describe, measure and draw a group from a word",
        )
    ]


@hookimpl
def orbiframe_warm_up() -> list[str]:
    """The elements of a group, and what lives on its orbifold."""
    return [
        "group abABcdCD --spectrum 3 --systole",
    ]
