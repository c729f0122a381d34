"""Config keys: every key of a configuration with its type, default and meaning, read off the components.

One source for the reference page, the JSON Schema and the commented default.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from orbiframe.components.options import Option, options_of
from orbiframe.components.registry import Registry, resolve
from orbiframe.errors import PluginError
from orbiframe.fitting.config import STEPS, TABLES, Boundary, Data, Output
from orbiframe.plugin import OPEN_NAMES, Component

TABLE_MEANINGS = {
    "mesh": "The file.",
    "geometry": "The plane X.",
    "group": "Where the group comes from.",
    "marking": "Only for a group with a name: the mesh is cut open along loops, and the word of its boundary goes"
    " to the group.",
    "map": "The map from the mesh to X/H.",
    "shape": "Only where an optimizer is named: the map is changed so that faces become regular polygons in X/H, "
    "as far as the surface allows.",
    "solver": "What solves the sparse equations of the map.",
    "data": "What the mesh means.",
    "basis": "The functions.",
    "fitter": "How their coefficients are found.",
    "output": "What is made of the surface.",
}
SELECTOR_MEANINGS = {
    "mesh": "name of a reader; auto takes the one of the suffix",
    "geometry": "name of a geometry; auto takes s2, e2 or h2 by the sign of the Euler characteristic, which another "
    "one must have as its curvature",
    "group": "where the group comes from; with mesh, the one that fits the mesh is found; else the name of a group",
    "marking": "name of a marker; auto takes tree-cotree",
    "map": "name of a parametrizer; auto takes sphere for χ > 0 and harmonic for χ ≤ 0, or equivariant if the "
    "group has a name",
    "shape": "name of an optimizer, such as regular-faces; none: the map stays as it is",
    "solver": "name of a solver; auto: METIS orders the edges of a mesh once for all its equations, SuperLU factors "
    "them",
    "basis": "name of a basis",
    "fitter": "name of a fitter: sliding, least-squares for the linear fit that sliding begins with, or "
    "smoothing, whose fairing cross-validation finds",
}
_BOUNDARY_MEANING = (
    "what to do with a mesh that has a boundary: error, refuse it; else how it is closed for the map, while the "
    "surface ends where the mesh ends: cap, over each loop; collar, with a strip about it first, which corners need; "
    "double, with a second copy of mesh and strip, for long tubes; auto takes double for annuli and Möbius bands, "
    "else collar"
)
_LIKE_MEANING = (
    "a saved surface, relative to this file, whose map is taken over, for its mesh moved or cut finer; if not given, a "
    "map is made"
)
_RESULT_MEANINGS = {
    "data.means": "what the mesh means: facets, the polyhedron is the truth; smooth, its vertices lie on a smooth"
    " surface; semi-smooth, so they do where facets are curved; auto decides by the share of its "
    "bending that lies in edges of more than 40°: smooth up to 20 %, facets from 47.5 % on",
    "data.lift": "a smooth mesh is mapped a second time, with its vertices lifted onto a first surface, unless its "
    "edges are shorter than 0.3 of the distance of functions, so that no facet shows",
    "data.noise": "root mean square error of each coordinate of the vertices of a smooth mesh, relative to the "
    "diagonal of the bounding box; if not given, the fairing is found from the vertices by cross-"
    "validation",
    "data.creases": "edges of the mesh that bend by so many degrees or more stay sharp, or 'marked': those that its "
    "file marks; if not given, the surface is "
    "smooth everywhere",
    "data.fixed": "points that the surface passes through exactly: lists of x, y, z, or of x, y, z and a normal nx, "
    "ny, nz that it has there, in lengths of the mesh; each at the nearest point of the mesh",
    "output.refine": "every triangle of the input becomes refine² triangles; if not given, the refined mesh is "
    "cut, about 40 000 triangles in all, of even size",
    "output.tolerance": "largest root mean square error, relative to the diagonal of the bounding box; if given, "
    "functions are added where the error is, from 500 up to 16 000 in all, until it is "
    "reached",
    "output.uv": "the mesh gets texture coordinates: X/H is cut open and laid into the unit square, for .obj, .gltf "
    "and .glb",
    "output.moved": "coefficients moved by hand after the fit: lists of the number of a function and x, y, z in "
    "lengths of the mesh, as `orbiframe edit` writes them",
    "output.max_error": "largest error anywhere, likewise; both may be given",
}
PLUGINS_MEANING = "Python files with components, relative to this file"


@dataclass(frozen=True, slots=True)
class ConfigKey:
    """A key of a table: its type, default and meaning; component: whose option it is, empty for a key of the table."""

    table: str
    name: str
    annotation: Any
    default: Any
    meaning: str
    component: str = ""
    choices: tuple[str, ...] = ()


def config_keys(registry: Registry) -> Iterator[ConfigKey]:
    """All keys of a configuration, in the order of its tables: the key that names the component, then its options.

    Components that cannot be imported are left out.
    """
    for table in TABLES:
        if table in STEPS:
            yield from _step_keys(table, registry)
            if table == "mesh":
                yield ConfigKey("mesh", "boundary", Boundary, "error", _BOUNDARY_MEANING)
            if table == "map":
                yield ConfigKey("map", "like", str, None, _LIKE_MEANING)
        else:
            yield from _result_keys(table, Data if table == "data" else Output)


def _step_keys(table: str, registry: Registry) -> Iterator[ConfigKey]:
    kind, selector, default = STEPS[table]
    components = registry.components(kind)
    choices = (*((default,) if default in OPEN_NAMES else ()), *(component.name for component in components))
    yield ConfigKey(table, selector, str, default, SELECTOR_MEANINGS[table], choices=choices)
    for component in components:
        for option in _options(component):
            meaning = component.meanings.get(option.name, "")
            value = None if option.required else option.default
            yield ConfigKey(table, option.name, option.annotation, value, meaning, component.name)


def _options(component: Component) -> list[Option]:
    try:
        return options_of(resolve(component))
    except PluginError:
        return []


def _result_keys(table: str, options: type) -> Iterator[ConfigKey]:
    for option in options_of(options):
        name = f"{table}.{option.name}"
        yield ConfigKey(table, option.name, option.annotation, option.default, _RESULT_MEANINGS.get(name, ""))
