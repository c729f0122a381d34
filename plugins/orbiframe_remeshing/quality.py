"""Quality of a mesh in numbers: angles, edges, valences."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe_remeshing.surface_mesh import corner_angles

Floats = NDArray[np.float64]

# A triangle with a smaller angle is worth a warning, in degrees.
SMALL = 25.0


def quality(mesh: Polyhedron) -> dict[str, Any]:
    """What a user asks of a mesh of equal faces, as plain data.

    angles in degrees: the least, the mean of the least of every face, the greatest, the number of faces with one below
    25 and the middle of the worst face; edges: mean, standard deviation, shortest and longest; regular: the share of
    vertices with one edge more or less than six (triangles) or four (quadrilaterals), or just as many, of those
    off a boundary.
    """
    size = int(mesh.face_sizes[0])
    faces = mesh.tail.reshape(-1, size)
    angles = corner_angles(mesh.vertices, faces)
    least, lengths = angles.min(axis=1), mesh.edge_lengths[mesh.representative]
    valence, inner = np.bincount(mesh.tail, minlength=len(mesh.vertices)), np.ones(len(mesh.vertices), dtype=np.bool_)
    inner[np.concatenate([ends[mesh.twin < 0] for ends in (mesh.tail, mesh.head)])] = False
    return {
        "vertices": len(mesh.vertices),
        "faces": len(faces),
        "corners": size,
        "angles": {
            "least": float(least.min()),
            "mean_of_least": float(least.mean()),
            "greatest": float(angles.max()),
            "small": int((least < SMALL).sum()),
            "worst": mesh.vertices[faces[least.argmin()]].mean(axis=0).tolist(),
        },
        "edges": {
            "mean": float(lengths.mean()),
            "deviation": float(lengths.std()),
            "shortest": float(lengths.min()),
            "longest": float(lengths.max()),
        },
        "regular": float((np.abs(valence - (6 if size == 3 else 4)) <= 1)[inner].mean()) if inner.any() else 1.0,
    }
