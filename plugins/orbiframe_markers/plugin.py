"""Markers: ways to cut a closed polyhedron open to a disc, for groups that are named."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """Greedy short loops."""
    return [
        Component(
            "marker",
            "tree-cotree",
            "orbiframe_markers.tree_cotree:tree_cotree",
            "short loops by a tree of shortest paths and the dual tree that leaves the shortest loops",
            meanings={"bases": "how many base points are tried; the one with the shortest loops is kept"},
        )
    ]
