"""Size: how many functions a shape needs."""

from __future__ import annotations

from orbiframe.functions.basis import Basis

LEAST_SIZE = 1000
_PER_HANDLE = 12
# A function sees the scale of the map change by no more than it can follow if there are so many sites per unit energy.
_SITES_PER_ENERGY = 1 / 3
# Polynomials on triangles follow it less than functions about a site do.
_VERTICES_PER_ENERGY = 2 / 3
_FUNCTIONS_PER_ENERGY = 2.5
_VERTICES_PER_FUNCTION, _MOST = 2.0, 2000


def default_size(energy: float, vertices: int, euler_characteristic: int) -> int:
    """The number of functions for a shape with this energy of its girth, and a mesh with so many vertices.

    1000, or more for thin parts, for handles, and, up to a point, for a fine mesh.
    """
    wanted = (
        _FUNCTIONS_PER_ENERGY * energy,
        _PER_HANDLE * (2 - euler_characteristic) / 2,
        min(vertices / _VERTICES_PER_FUNCTION, _MOST),
    )
    return max(LEAST_SIZE, round(max(wanted)))


def size_needed(basis: Basis, energy: float) -> int:
    """The number of functions of the kind of a basis for which its sites follow the map; at most its own if they do."""
    domain = getattr(basis, "domain", None)
    if domain is None:
        return round(energy * _SITES_PER_ENERGY)
    return round(basis.size * energy * _VERTICES_PER_ENERGY / int(domain.vertex_count))
