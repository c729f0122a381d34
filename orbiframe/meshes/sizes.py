"""Sizes: areas, volume, edge lengths and valences of a polyhedron, and what a user should know of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.coincident_points import unit_scale
from orbiframe.meshes.orientation import oriented
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.surface_type import surface_type

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# A face is a needle if it is thinner than this, relative to its longest edge.
_THIN = 1e-4
# Squares and cubes of lengths beyond these leave the range of float64.
_SMALL, _LARGE = 1e-100, 1e100
# Digits for the shape are lost where the offset is this many diagonals.
_FAR = 1e4


@dataclass(frozen=True, slots=True)
class Note:
    """Something to know of the sizes in a polyhedron that is no flaw."""

    kind: str
    count: int
    where: str


def area(polyhedron: Polyhedron) -> float:
    """The area of all faces; of a face that is not plane, the largest that a projection of its outline has."""
    unit, scale = _scaled(polyhedron)
    return _rescaled(float(np.linalg.norm(vector_areas(unit), axis=1).sum()), scale, 2)


def signed_volume(polyhedron: Polyhedron) -> float | None:
    """The volume within a closed orientable polyhedron, negative where most faces look inward; None for any other.

    A face that is not plane is filled by triangles to the mean of its corners. Components add up, so that a shell
    turned inward is a cavity. Faces that are not oriented alike are oriented first, by majority.
    """
    surface = surface_type(polyhedron)
    if not (surface.closed and surface.orientable):
        return None
    unit, scale = _scaled(oriented(polyhedron))
    sums = np.stack([np.bincount(unit.face, weights=x) for x in unit.vertices[unit.tail].T], axis=1)
    centre = sums / unit.face_sizes[:, None]
    # About a point of the mesh, so that an offset costs no digits.
    origin = unit.vertices[unit.tail[0]]
    a, b, c = unit.vertices[unit.tail] - origin, unit.vertices[unit.head] - origin, (centre - origin)[unit.face]
    return _rescaled(float(np.einsum("hi,hi->", np.cross(a, b), c)) / 6, scale, 3)


def edge_lengths(polyhedron: Polyhedron) -> Floats:
    """The length of every edge, (E,)."""
    unit, scale = _scaled(polyhedron)
    with np.errstate(over="ignore"):
        return unit.edge_lengths[unit.representative] / scale


def valences(polyhedron: Polyhedron) -> Ints:
    """The number of edges at every vertex that has any."""
    ends = np.concatenate([end[polyhedron.representative] for end in (polyhedron.tail, polyhedron.head)])
    count = np.bincount(ends)
    return count[count > 0]


def needles(polyhedron: Polyhedron) -> Ints:
    """The faces with an area whose mean width is less than a ten-thousandth of their longest edge."""
    unit, _ = _scaled(polyhedron)
    longest = np.zeros(unit.face_count)
    np.maximum.at(longest, unit.face, unit.edge_lengths)
    thin = np.flatnonzero(2 * np.linalg.norm(vector_areas(unit), axis=1) < _THIN * longest**2)
    return np.setdiff1d(thin, faces_without_area(polyhedron))


def notes(polyhedron: Polyhedron) -> list[Note]:
    """Needles, very large, very small and far-off coordinates: no flaws, but worth knowing."""
    found = []
    thin = needles(polyhedron)
    if len(thin):
        where = "faces " + ", ".join(map(str, thin[:5])) + (", …" if len(thin) > 5 else "")
        found.append(Note("needles", len(thin), f"{where}, thinner than {_THIN:g} of their longest edge"))
    used = polyhedron.vertices[np.bincount(polyhedron.tail, minlength=len(polyhedron.vertices)) > 0]
    size = math.hypot(*np.ptp(used / 4, axis=0)) * 4 if len(used) else 0.0
    largest = float(np.abs(used).max(initial=0.0))
    if size > _LARGE or 0 < size < _SMALL:
        found.append(Note("extreme coordinates", len(used), f"a size of {size:.1e}; a fit scales the mesh first"))
    if size and largest > _FAR * size:
        digits = max(0, 15 - math.ceil(math.log10(largest / size)))
        found.append(
            Note("far from the origin", len(used), f"{largest / size:.0e} times its size; {digits} digits are left")
        )
    return found


def _scaled(polyhedron: Polyhedron) -> tuple[Polyhedron, float]:
    """The polyhedron times the power of two that makes its coordinates about 1 at most, and that power."""
    points, scale = unit_scale(polyhedron.vertices, 1.0)
    return polyhedron.with_vertices(points), scale


def _rescaled(value: float, scale: float, power: int) -> float:
    """The value divided by a power of the scale; infinite or 0 where that leaves the range of float64."""
    for _ in range(power):
        value /= scale
    return value


def vector_areas(polyhedron: Polyhedron) -> NDArray[np.float64]:
    """The area of every face times its normal, (F, 3): half the sum of the cross products round the face."""
    if polyhedron.is_triangular:
        a, b, c = (polyhedron.vertices[ends] for ends in polyhedron.triangles.T)
        return _crossed(b - a, c - a)
    origin = polyhedron.vertices[polyhedron.tail[polyhedron.offsets[polyhedron.face]]]
    cross = _crossed(polyhedron.vertices[polyhedron.tail] - origin, polyhedron.vertices[polyhedron.head] - origin)
    total = np.zeros((polyhedron.face_count, 3))
    for axis in range(3):
        total[:, axis] = np.bincount(polyhedron.face, weights=cross[:, axis], minlength=polyhedron.face_count)
    return total


def _crossed(a: Floats, b: Floats) -> Floats:
    """Half the cross products of rows, with no zero that is negative."""
    found = np.empty(a.shape)
    for axis in range(3):
        y, z = (axis + 1) % 3, (axis + 2) % 3
        found[:, axis] = (a[:, y] * b[:, z] - a[:, z] * b[:, y]) / 2 + 0.0
    return found


def faces_without_area(polyhedron: Polyhedron) -> Ints:
    """The faces whose area is nothing beside the square of the bounding box's diagonal; none where that is infinite."""
    if not np.isfinite(polyhedron.vertices).all():
        return np.empty(0, dtype=np.intp)
    unit = polyhedron.with_vertices(unit_scale(polyhedron.vertices)[0])
    return np.flatnonzero(np.linalg.norm(vector_areas(unit), axis=1) <= 1e-14 * unit.diagonal**2)
