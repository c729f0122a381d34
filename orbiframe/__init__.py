"""orbiframe: one truly smooth surface from any closed polyhedron, and function spaces on closed surfaces.

The public names below are loaded on first use, so that importing orbiframe loads no numpy.
"""

from importlib import import_module
from typing import TYPE_CHECKING

# For type checkers and editors: the same names once more.
if TYPE_CHECKING:
    from orbiframe.atlas import Atlas as Atlas, Points as Points
    from orbiframe.basis import (
        Basis as Basis,
        DifferentiableBasis as DifferentiableBasis,
        OrbitSumBasis as OrbitSumBasis,
    )
    from orbiframe.errors import (
        ConfigError as ConfigError,
        FitError as FitError,
        FormatError as FormatError,
        GeometryError as GeometryError,
        MapError as MapError,
        OrbiframeError as OrbiframeError,
        PluginError as PluginError,
        TopologyError as TopologyError,
        UsageError as UsageError,
    )
    from orbiframe.fitter import Fitter as Fitter
    from orbiframe.geometry import Geometry as Geometry
    from orbiframe.group import Group as Group
    from orbiframe.motion import Motion as Motion
    from orbiframe.orbifold import Orbifold as Orbifold
    from orbiframe.plugin import Component as Component, hookimpl as hookimpl
    from orbiframe.polygon import FundamentalPolygon as FundamentalPolygon, regular_polygon as regular_polygon
    from orbiframe.polygon_group import PolygonGroup as PolygonGroup
    from orbiframe.polyhedron import Polyhedron as Polyhedron
    from orbiframe.quadrature import triangle_points as triangle_points, triangle_rule as triangle_rule
    from orbiframe.samples import Samples as Samples
    from orbiframe.spacing import (
        Graph as Graph,
        Spacing as Spacing,
        curve_order as curve_order,
        dijkstra_forest as dijkstra_forest,
        edge_graph as edge_graph,
        farthest_points as farthest_points,
    )
    from orbiframe.topology import (
        SurfaceType as SurfaceType,
        fan_labels as fan_labels,
        reversed_faces as reversed_faces,
        surface_type as surface_type,
    )
    from orbiframe.triangulation import Triangulation as Triangulation
    from orbiframe.word import Word as Word, standard_word as standard_word

_HOMES = {
    "errors": "OrbiframeError UsageError ConfigError PluginError FormatError TopologyError GeometryError MapError FitError",
    "plugin": "Component hookimpl",
    "geometry": "Geometry",
    "motion": "Motion",
    "word": "Word standard_word",
    "group": "Group",
    "polygon": "FundamentalPolygon regular_polygon",
    "polygon_group": "PolygonGroup",
    "quadrature": "triangle_rule triangle_points",
    "atlas": "Atlas Points",
    "orbifold": "Orbifold",
    "polyhedron": "Polyhedron",
    "triangulation": "Triangulation",
    "samples": "Samples",
    "basis": "Basis DifferentiableBasis OrbitSumBasis",
    "fitter": "Fitter",
    "topology": "SurfaceType surface_type fan_labels reversed_faces",
    "spacing": "edge_graph farthest_points dijkstra_forest curve_order Graph Spacing",
}
_HOME = {name: module for module, names in _HOMES.items() for name in names.split()}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'orbiframe' has no attribute '{name}'")
    value = getattr(import_module(f"orbiframe.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
