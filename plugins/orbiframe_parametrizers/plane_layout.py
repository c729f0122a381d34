"""Plane layout: a sphere without one face in the plane, as its circle packing or by a harmonic map with a pole."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe_parametrizers.elimination import Elimination

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Complexes = NDArray[np.complex128]


def packed_layout(mesh: Polyhedron, angles: Floats, hole: int) -> Complexes:
    """The centres (V,) of a circle packing with corner angles (H,), the corners of the hole clockwise on unit circles.

    With the cotangents of a flat metric linear functions are harmonic: the layout is the solution of one linear
    system with three fixed vertices. The edges between those are fixed at both ends, so that the hole does not matter.
    """
    with np.errstate(divide="ignore"):
        cotangents = 0.5 / np.tan(angles.reshape(-1, 3))
    half = np.roll(cotangents, -2, axis=1).ravel()
    corners = mesh.triangles[hole]
    position = np.zeros(len(mesh.vertices), dtype=np.complex128)
    position[corners] = 2 / np.sqrt(3) * np.exp(1j * (np.pi / 2 - 2 * np.pi / 3 * np.arange(3)))
    return _solved(mesh, half + half[mesh.twin], corners, position, np.zeros_like(position))


def harmonic_layout(mesh: Polyhedron, weights: Floats, pole: int) -> Complexes:
    """The harmonic map (V,) to the plane with a simple pole in one face, conformal as the weights (H,) see it.

    The sources at the corners of the face are the derivatives of the hat functions: a discrete derivative of the delta
    function (Haker et al., Conformal surface parameterization for texture mapping, 2000), so that the face gets its
    shape from the mesh. One vertex is fixed; scale and rotation are arbitrary.
    """
    corners = mesh.triangles[pole]
    a, b, c = mesh.vertices[corners]
    along = (b - a) / np.linalg.norm(b - a)
    x, y = float(along @ (c - a)), float(np.linalg.norm((c - a) - along * (along @ (c - a))))
    length = float(np.linalg.norm(b - a))
    position = np.zeros(len(mesh.vertices), dtype=np.complex128)
    source = np.zeros_like(position)
    # Gradients of the hat functions in the plane of the face, with corners 0, (length, 0), (x, y).
    gradient = np.array([[-1 / length, (x - length) / (length * y)], [1 / length, -x / (length * y)], [0, 1 / y]])
    source[corners] = gradient[:, 0] - 1j * gradient[:, 1]
    far = int(np.argmax(np.linalg.norm(mesh.vertices - a, axis=1)))
    return _solved(mesh, weights, np.array([far]), position, source)


def _solved(mesh: Polyhedron, weights: Floats, fixed: Ints, position: Complexes, source: Complexes) -> Complexes:
    """The solution of sum over edges of w (z_i - z_j) = source_i at the free vertices, z = position at the fixed."""
    count = len(position)
    held = np.zeros(count, dtype=np.bool_)
    held[fixed] = True
    i, j = mesh.tail, mesh.head
    known = ~held[i] & held[j]
    right = source.copy()
    np.add.at(right, i[known], weights[known] * position[j[known]])
    right[fixed] = position[fixed]
    diagonal = np.where(held, 1.0, np.bincount(i, weights=weights, minlength=count))
    inner = np.flatnonzero(mesh.representative & ~held[i] & ~held[j])
    solve = Elimination.of(mesh).solver(i[inner], j[inner], -weights[inner], diagonal)
    solution = solve(np.stack([right.real, right.imag], axis=1))
    return np.asarray(solution[:, 0] + 1j * solution[:, 1])
