"""Report: what a fit did, as plain data for people and machines."""

from __future__ import annotations

import math
import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe.fitting.accuracy import APART, PLACES, Accuracy, Distances, Place
from orbiframe.fitting.approximation import Approximation
from orbiframe.fitting.config import Config
from orbiframe.fitting.inspection import Inspection
from orbiframe.fitting.mapping import Mapping
from orbiframe.functions.basis import DifferentiableBasis
from orbiframe.meshes.edge_paths import first_largest
from orbiframe.meshes.face_diagonals import RULE, cut_into_triangles
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.surface_type import SurfaceType
from orbiframe.surfaces.border import Border
from orbiframe.surfaces.crease_quality import crease_quality
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.surfaces.textures import texture_distortion
from orbiframe.triangulations.face_shapes import FaceShapes
from orbiframe.triangulations.local_girth import girth_radius
from orbiframe.triangulations.lost_digits import crowding_of
from orbiframe.triangulations.triangulation import Triangulation

_PACKAGES = ("orbiframe", "numpy", "scipy", "numba")


def report(
    surface: OrbifoldSurface,
    surface_type: SurfaceType,
    mapping: Mapping,
    config: Config,
    found: Approximation,
    output: Polyhedron,
    inspection: Inspection,
    seconds: dict[str, float],
) -> dict[str, Any]:
    """All that a user should know of a fit, with plain numbers and strings only."""
    triangulation = surface.triangulation
    area_in_space = float(np.linalg.norm(vector_areas(triangulation.polyhedron), axis=1)[triangulation.own_faces].sum())
    quality = crease_quality(surface)
    rms, largest = found.accuracy.against(found.meaning.smooth)
    return {
        "surface": {
            "name": surface_type.name,
            "euler_characteristic": surface_type.euler_characteristic,
            "orientable": surface_type.orientable,
            "genus": surface_type.genus,
            "components": surface_type.components,
        },
        "boundary": _border_report(found.accuracy.border, mapping, found.meaning.smooth),
        "triangles": _cut_report(mapping.polyhedron, surface.refinement.coarse),
        "geometry": triangulation.orbifold.geometry.name,
        "group": {
            "source": triangulation.group,
            "patches": triangulation.orbifold.atlas.patch_count,
            "relation_defect": triangulation.relation_defect,
        },
        "map": {**_map_report(triangulation), "like": _like_report(mapping, found)},
        "faces": _faces_report(*found.mapped.face_shapes(mapping.polyhedron), _own_faces(mapping)),
        "data": {
            "means": found.meaning.name,
            "reason": found.meaning.reason,
            "bend_share": found.meaning.bend_share,
            "girth_energy": found.energy,
            "fixed": len(config.data.fixed),
        },
        "fit": {
            "basis": config.basis.name,
            "fitter": config.fitter.name,
            "size": surface.basis.size,
            "samples": int((found.samples.weights > 0).sum()),
            "rms": rms,
            "max": largest,
        },
        "distance": _distances_report(found.accuracy, surface, inspection.away),
        "shape": {
            "folded_share": inspection.folded,
            "self_intersections": {"mesh": len(inspection.in_mesh), "output": len(inspection.in_output)},
            "volume_ratio": inspection.volume,
            "girth": girth_radius(found.mapped.triangulation),
            "spacing": float(np.sqrt(area_in_space / surface.basis.size)),
        },
        "curvature": _curvature_report(surface),
        "uv": _texture_report(output),
        "creases": None if quality is None else quality._asdict() | {"angle_from": config.data.creases},
        "notes": [
            *found.notes,
            *_like_notes(mapping, triangulation),
            *inspection.notes(output),
            *(() if quality is None else quality.notes()),
        ],
        "output": {
            "vertices": len(output.vertices),
            "faces": output.face_count,
            "euler_characteristic": len(output.vertices) - output.edge_count + output.face_count,
        },
        "seconds": {stage: round(spent, 4) for stage, spent in seconds.items()},
        "versions": versions(),
    }


def _like_report(mapping: Mapping, found: Approximation) -> dict[str, Any] | None:
    """From which surface the map was taken over, and how; None where it was made."""
    carried = found.mapped.carried
    return None if mapping.like is None or carried is None else mapping.like.report(carried)


def _like_notes(mapping: Mapping, triangulation: Triangulation) -> tuple[str, ...]:
    return () if mapping.like is None else mapping.like.notes(triangulation)


def _border_report(border: Border | None, mapping: Mapping, smooth: bool) -> dict[str, Any] | None:
    """The boundary, how the mesh was closed for the map, and how near the boundary of the surface is to it."""
    if border is None:
        return None
    parts = (border.vertices_to_surface,) if smooth else (border.mesh_to_surface, border.surface_to_mesh)
    rms, largest = (max(column) for column in zip(*parts, strict=True))
    closed = {"closed_by": mapping.closing, "closed_to": mapping.surface_type.name}
    return {"loops": border.loops, **closed, "rms": rms, "max": largest, "least_element": border.least_element}


def _own_faces(mapping: Mapping) -> int:
    """The number of faces of the polyhedron that do not only close it: they come first."""
    if mapping.inside is None:
        return mapping.polyhedron.face_count
    return int(cut_into_triangles(mapping.polyhedron).face[mapping.inside].max()) + 1


def _faces_report(now: FaceShapes, before: FaceShapes | None, count: int) -> dict[str, Any]:
    """The shapes of the first faces of the polyhedron in X, and before an optimizer changed them, if one did."""
    return {**now.first(count).summary(), "before": None if before is None else before.first(count).summary()}


def _distances_report(accuracy: Accuracy, surface: OrbifoldSurface, of_output: float) -> dict[str, Any]:
    """Distances in diagonals, with the places in the coordinates of the mesh where they are largest.

    of_output: the largest distance of a vertex of the output to the mesh.
    """
    named = {
        "mesh_to_surface": accuracy.to_surface,
        "surface_to_mesh": accuracy.to_mesh,
        "vertices_to_surface": accuracy.vertices,
    }
    return {name: _distances_part(part, surface) for name, part in named.items()} | {
        "arcs_to_surface": None if accuracy.arcs is None else _distances_part(accuracy.arcs, surface),
        "hausdorff": max(accuracy.to_surface.max, accuracy.to_mesh.max, of_output),
        "normals": accuracy.normals,
        "worst": _worst(accuracy, surface),
    }


def _distances_part(part: Distances, surface: OrbifoldSurface) -> dict[str, Any]:
    return {"rms": part.rms, "mean": part.mean, "max": part.max, "place": _in_space(surface, part.place)}


def _worst(accuracy: Accuracy, surface: OrbifoldSurface) -> list[dict[str, Any]]:
    """Where mesh and surface are farthest from each other, the worst place first."""
    both = {"mesh": accuracy.to_surface.places, "surface": accuracy.to_mesh.places}
    found = [(each, name) for name, places in both.items() for each in places]
    told: list[tuple[Place, str]] = []
    left = np.array([each.distance for each, _ in found])
    for _ in found:
        next_one = first_largest(left)
        (each, name), left[next_one] = found[next_one], -1.0
        if all(math.dist(each.place, other.place) > APART for other, _ in told):
            told.append((each, name))
    return [
        {"on": name, "distance": each.distance, "place": _in_space(surface, each.place)} for each, name in told[:PLACES]
    ]


def _in_space(surface: OrbifoldSurface, place: tuple[float, float, float]) -> list[float]:
    return [float(x) for x in surface.origin + surface.scale * np.array(place)]


def _cut_report(polyhedron: Polyhedron, triangles: Polyhedron) -> dict[str, Any]:
    """How the faces of the input were cut into triangles."""
    larger = polyhedron.face_sizes[polyhedron.face_sizes > 3]
    return {
        "faces_cut": len(larger),
        "diagonals": int((larger - 3).sum()),
        "points": len(triangles.vertices) - len(polyhedron.vertices),
        "rule": RULE if len(larger) else "none",
    }


def _map_report(triangulation: Triangulation) -> dict[str, Any]:
    own = triangulation.own_faces
    weights = np.linalg.norm(vector_areas(triangulation.polyhedron), axis=1)[own]
    distortion = triangulation.angle_distortion[own]
    median, p95 = _weighted_quantiles(distortion, weights, [0.5, 0.95])
    return {
        "triangles": triangulation.polyhedron.face_count,
        "not_positive": triangulation.not_positive,
        "area_defect": triangulation.area_defect,
        "crowding": _crowding_report(triangulation),
        "angle_distortion": {"median": median, "p95": p95, "max": float(distortion.max())},
        "weights": triangulation.weights,
    }


def _curvature_report(surface: OrbifoldSurface) -> dict[str, Any] | None:
    """The curvatures at the vertices of the refined mesh, in units of the file; None without derivatives."""
    if not isinstance(surface.basis, DifferentiableBasis):
        return None
    with np.errstate(all="ignore"):
        found = surface.curvature(surface.vertex_points)
        bent = np.abs(found.mean) + np.sqrt(np.maximum(found.mean**2 - found.gaussian, 0.0))
        radius = float(1 / bent.max())
    levels = {"min": 0.0, "p05": 0.05, "median": 0.5, "p95": 0.95, "max": 1.0}
    return {
        name: dict(zip(levels, _weighted_quantiles(values, found.element, list(levels.values())), strict=True))
        for name, values in (("gaussian", found.gaussian), ("mean", np.abs(found.mean)))
    } | {"radius": radius}


def _texture_report(output: Polyhedron) -> dict[str, Any] | None:
    """How texture coordinates distort the mesh, weighted by area in space; None without any."""
    if output.corner_uv is None:
        return None
    found, weights = texture_distortion(output), np.linalg.norm(vector_areas(output), axis=1)
    median, p95 = _weighted_quantiles(found.angle, weights, [0.5, 0.95])
    least, most = _weighted_quantiles(found.area, weights, [0.05, 0.95])
    return {
        "cut": found.cut,
        "folded": found.folded,
        "angle_distortion": {"median": median, "p95": p95, "max": float(found.angle.max())},
        "area_distortion": {"p5": least, "p95": most},
    }


def _crowding_report(triangulation: Triangulation) -> dict[str, float]:
    """The lost digits to three places: the origins of patches, from which they are counted, are set no better."""
    crowding = crowding_of(triangulation)
    return {**crowding._asdict(), "digits_lost": round(crowding.digits_lost, 3)}


def _weighted_quantiles(values: NDArray[np.float64], weights: NDArray[np.float64], levels: list[float]) -> list[float]:
    order = np.argsort(values, kind="stable")
    share = np.cumsum(weights[order]) / weights.sum()
    places = np.minimum(np.searchsorted(share, levels), len(order) - 1)
    return [float(value) for value in values[order[places]]]


def versions() -> dict[str, str]:
    """The versions that a result depends on."""
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found
