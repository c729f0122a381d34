"""Fixed points: where a user wants the surface of a mesh to pass, and with which normals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.components.options import place_of
from orbiframe.errors import ConfigError
from orbiframe.fitting.config import Config
from orbiframe.fitting.mapping import Mapped, Mapping
from orbiframe.functions.samples import Samples, joined
from orbiframe.meshes.nearest_points import NearestPoints
from orbiframe.meshes.submesh import submesh

Floats = NDArray[np.float64]

# So far from the mesh, in its diagonals, a fixed point is more likely one of another mesh or in another unit.
_FAR = 0.25


def with_fixed(samples: Samples, mapping: Mapping, mapped: Mapped, config: Config) -> Samples:
    """The samples, and the fixed points of a configuration, each at the nearest point of the mesh.

    Raises ConfigError for a point that is far from the mesh, and for a normal of length 0.
    """
    if not config.data.fixed:
        return samples
    rows = np.array([(*row, *([np.nan] * (6 - len(row)))) for row in config.data.fixed])
    normals = _unit_normals(rows, config)
    places = (rows[:, :3] - mapping.origin) / mapping.scale
    own, flat = mapped.triangulation.inside, mapped.refinement.polyhedron
    mesh = flat if own is None else submesh(flat, own).mesh
    face, barycentric = NearestPoints(mesh).places(places)
    there = np.einsum("nc,nci->ni", barycentric, mesh.vertices[mesh.triangles[face]])
    _require_near(np.linalg.norm(there - places, axis=1), config)
    triangle = face if own is None else np.flatnonzero(own)[face]
    count = len(places)
    weight = np.full(count, samples.weights.sum() / (samples.weights > 0).sum())
    fixed = Samples(
        mapped.triangulation.locate(triangle, barycentric),
        places,
        weight,
        np.zeros(count),
        np.zeros(count),
        normals=normals,
        fixed=np.ones(count, dtype=np.bool_),
    )
    return joined(samples, fixed)


def _unit_normals(rows: Floats, config: Config) -> Floats:
    """The normals of rows x, y, z, nx, ny, nz, nan where there is none."""
    size = np.linalg.norm(rows[:, 3:], axis=1)
    for first in np.flatnonzero(size == 0)[:1]:
        raise ConfigError(
            f"{_place(config)}point {first}, {list(config.data.fixed[first])}, has a normal of length 0; give one that "
            "has a direction, or x, y, z alone"
        )
    return np.asarray(rows[:, 3:] / size[:, None])


def _require_near(distance: Floats, config: Config) -> None:
    far = np.flatnonzero(distance > _FAR)
    if len(far):
        raise ConfigError(
            f"{_place(config)}point {far[0]}, {list(config.data.fixed[far[0]])}, is {distance[far[0]]:.2g} diagonals "
            f"away from the mesh, at most {_FAR:g} is near; give points in the unit of the mesh"
        )


def _place(config: Config) -> str:
    return f"{place_of('data.fixed', config.places)}data.fixed: "
