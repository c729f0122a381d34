"""Named groups: surfaces whose shape is chosen by a construction and not found from a mesh."""

from __future__ import annotations

from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The groups of the paper, section 2.5."""
    return [
        Component(
            "group",
            "regular-polygon",
            "orbiframe_groups.regular_polygon:regular_polygon_group",
            "sides of a regular polygon glued by any word with one vertex, the paper's choice",
        ),
        Component(
            "group",
            "lattice",
            "orbiframe_groups.lattice:lattice_group",
            "a parallelogram glued to a torus of any shape, or to a Klein bottle",
            meanings={"first": "the vector of side 0", "second": "the vector of side 1"},
        ),
        Component(
            "group",
            "finite",
            "orbiframe_groups.finite:FiniteGroup",
            "the sphere itself, or the projective plane as its antipodal quotient",
        ),
    ]
