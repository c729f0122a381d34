"""orbiframe: one truly smooth surface from any closed polyhedron, and function spaces on closed surfaces.

The public names below are loaded on first use, so that importing orbiframe loads no numpy.
"""

from importlib import import_module

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
    "basis": "Basis DifferentiableBasis",
    "fitter": "Fitter",
    "topology": "SurfaceType surface_type fan_labels reversed_faces",
    "spacing": "edge_graph farthest_points dijkstra_forest",
}
_HOME = {name: module for module, names in _HOMES.items() for name in names.split()}

__all__ = sorted(_HOME)  # noqa: PLE0605


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'orbiframe' has no attribute '{name}'")
    value = getattr(import_module(f"orbiframe.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
