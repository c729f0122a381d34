"""Even map: a parametrizer that evens out the areas of the installed harmonic map."""

from __future__ import annotations

from orbiframe import Geometry, MapError, Polyhedron, Registry, Triangulation
from orbiframe.groups import MarkedGroup
from orbiframe.plugin import Component, hookimpl


@hookimpl
def orbiframe_components() -> list[Component]:
    """The parametrizer of this file."""
    return [Component("parametrizer", "even-map", "even_map:even_map", "the harmonic map with areas as in space")]


def even_map(
    polyhedron: Polyhedron, geometry: Geometry, group: MarkedGroup | None, *, rounds: int = 2
) -> Triangulation:
    """The installed harmonic map, or the equivariant one of a named group, with areas pulled towards those in space.

    rounds: how often they are pulled. Raises MapError for spheres, which have no such map.
    """
    if geometry.curvature > 0:
        raise MapError(f"'even-map' is for surfaces with handles or crosscaps, not for {geometry.name}")
    name = "harmonic" if group is None else "equivariant"
    parametrizer = Registry.discover().load("parametrizer", name)
    found: Triangulation = parametrizer(polyhedron, geometry, group, even_areas=rounds)
    return found
