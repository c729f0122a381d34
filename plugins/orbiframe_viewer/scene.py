"""Scene: what a page shows of a surface, as plain data: numbers in base64, about the origin, of unit size."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import Geometry, OrbifoldSurface, Polyhedron
from orbiframe.surfaces import edge_curves, shown_values
from orbiframe.triangulations import Tessellation, geodesic_sides

Floats = NDArray[np.float64]
Scene = dict[str, Any]

FACES = 40_000
_STEPS = 8  # pieces of an edge
_PIECE, _MOST_PIECES = 0.1, 24  # the length in X of those of geodesics, and how many one has
_ABOVE = 1.004  # edges on the sphere are drawn so far from its centre
_MOST_EDGES = 20_000
_MOST_FAR = 10_000  # edges of the copies of X/H round the one in the middle


def surface_scene(surface: OrbifoldSurface, polyhedron: Polyhedron | None, name: str, *, faces: int = FACES) -> Scene:
    """A smooth surface, the polyhedron it was made of (by default its triangles), and X/H beside it."""
    flat = surface.triangulation
    density = max(1, round(math.sqrt(faces / flat.polyhedron.face_count)))
    fine = surface.tessellation(density, bisected=True)
    count = len(flat.own_faces)
    if fine.mesh.face_count != density**2 * count:
        density, fine = 1, surface.tessellation(1, bisected=True)
    own = surface.own_mesh
    given = polyhedron or own.with_vertices(surface.origin + surface.scale * own.vertices)
    values = shown_values(surface, fine)
    scene = _scene(fine.mesh, given, surface.origin, surface.scale, name)
    scene["values"] = [
        _value("error", "error: distance to the input, in diagonals", values.error, "rising"),
        _value("distortion", "distortion of angles by the map", values.distortion, "rising"),
    ]
    if values.mean is not None and values.gaussian is not None:
        scene["values"].append(_value("gaussian", "Gaussian curvature", values.gaussian, "diverging"))
        scene["values"].append(_value("mean", "mean curvature", values.mean, "diverging"))
    if given.edge_count <= _MOST_EDGES:
        curves = edge_curves(surface, polyhedron, steps=_STEPS)
        scene["edges"] = _pieces((curves - surface.origin) / surface.scale)
    if fine.mesh.face_count == density**2 * count:
        scene["xh"] = xh_scene(surface, polyhedron, density)
    return scene


def field_scene(mesh: Polyhedron, columns: dict[str, Floats], name: str) -> Scene:
    """A mesh with numbers (V,) at its vertices, as they are."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    scene = _scene(mesh, mesh, (low + high) / 2, float(np.linalg.norm(high - low)), name)
    scene["values"] = [
        _value(title, title, values, "diverging" if np.nanmin(values) < 0 < np.nanmax(values) else "rising")
        for title, values in columns.items()
    ]
    return scene


def _scene(mesh: Polyhedron, given: Polyhedron, origin: Floats, scale: float, name: str) -> Scene:
    corners = _triangles(mesh)
    ends = np.stack([given.tail, given.head], axis=1)[given.representative]
    faces = (given.vertices - origin) / scale
    return {
        "name": name,
        "origin": [float(x) for x in origin],
        "scale": float(scale),
        "position": packed((mesh.vertices - origin) / scale),
        "normal": None if mesh.normals is None else packed(mesh.normals),
        "index": packed(corners, np.uint32),
        "input": {
            "position": packed(faces[_triangles(given)]),
            "lines": packed(faces[ends]) if len(ends) <= 10 * _MOST_EDGES else packed(faces[:0]),
            "words": f"{len(given.vertices)} vertices, {given.face_count} faces",
        },
        "edges": None,
        "values": [],
        "xh": None,
    }


def _triangles(mesh: Polyhedron) -> NDArray[np.intp]:
    from orbiframe.meshes import triangulated

    return triangulated(mesh).triangles if (mesh.face_sizes != 3).any() else mesh.triangles


def xh_scene(surface: OrbifoldSurface, polyhedron: Polyhedron | None, density: int) -> dict[str, Any]:
    """One lift of every fine triangle to X, the edges of the input there, and those of copies round about."""
    flat, geometry = surface.triangulation, surface.orbifold.geometry
    grid = _grid(density)
    (lifts,) = Tessellation.of_triangles(flat).homes()
    lifts = lifts[flat.own_faces]
    fine = geometry.project(np.einsum("kcb,fbi->fkci", grid, lifts)).reshape(-1, 3, 3)
    tiling = Tessellation.of_map(polyhedron or surface.refinement.coarse, surface.refinement, flat)
    homes = tiling.homes()
    if polyhedron is None:
        homes = [homes[0][surface.own]]
    edges = np.concatenate([geodesic_sides(geometry, corners, _count(geometry, homes)) for corners in homes])
    lifted = _ABOVE if geometry.curvature > 0 else 1.0
    far = np.concatenate(list(_copies(surface, geometry, homes, len(edges))) or [edges[:0]])
    return {
        "geometry": geometry.name,
        "position": packed(_placed(geometry, fine)),
        "edges": _pieces(lifted * _placed(geometry, edges)),
        "far": _pieces(_placed(geometry, far)),
    }


def _grid(density: int) -> Floats:
    """Barycentric coordinates of the corners of the triangles that a refined one is cut into, (density^2, 3, 3)."""
    from orbiframe.meshes import grid_of

    return grid_of(density)


def _copies(surface: OrbifoldSurface, geometry: Geometry, homes: list[Floats], edges: int) -> Iterator[Floats]:
    """The edges moved by elements of the group, nearest first, as many as a picture bears; none on the sphere."""
    if geometry.curvature > 0:
        return
    count, radius = max(1, _MOST_FAR // max(edges, 1)), 1.0
    elements = np.zeros((0, 3, 3))
    while len(elements) <= count and radius < 12:
        patches, isometry = surface.orbifold.lifts(0, radius)
        elements, radius = isometry[patches == 0], 1.4 * radius
    away = geometry.distance(geometry.origin, elements[:, :, 0])
    for element in elements[np.argsort(away, kind="stable")][1 : count + 1]:
        for corners in homes:
            yield geodesic_sides(geometry, corners @ element.T, 4)


def _count(geometry: Geometry, homes: list[Floats]) -> int:
    """In how many pieces sides are drawn: on the sphere as many as keep the longest one outside of it."""
    if geometry.curvature <= 0:
        return 4
    longest = max(float(geometry.distance(x, np.roll(x, -1, axis=1)).max(initial=0.0)) for x in homes)
    return min(max(4, math.ceil(longest / _PIECE)), _MOST_PIECES)


def _placed(geometry: Geometry, x: Floats) -> Floats:
    """Points of X where a page shows them: on the sphere, in the plane, or in the conformal disc, (..., 3)."""
    if geometry.curvature > 0:
        return np.asarray(x[..., [1, 2, 0]])
    plane = geometry.to_chart("conformal", x)
    return np.concatenate([plane, np.zeros_like(plane[..., :1])], axis=-1)


def _value(name: str, title: str, values: Floats, kind: str) -> dict[str, Any]:
    finite = values[np.isfinite(values)]
    finite = finite if len(finite) else np.zeros(1)
    if kind == "diverging":
        reach = float(np.quantile(np.abs(finite), 0.97))
        low, high = -reach, reach
    else:
        low, high = float(finite.min()), float(np.quantile(finite, 0.995))
    return {"name": name, "title": title, "kind": kind, "low": low, "high": high, "data": packed(values)}


def _pieces(chains: Floats) -> str:
    """Chains of points (n, m, 3) as pairs of neighbours."""
    return packed(np.stack([chains[:, :-1], chains[:, 1:]], axis=2))


def packed(values: Any, kind: Any = np.float32) -> str:
    """An array as text: its bytes in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")
