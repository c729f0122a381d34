"""Plane layout: a sphere without one face in the plane, as its circle packing or by a harmonic map with a pole.

A thin limb of length L and radius r is mapped to a disc that is smaller by exp(-L/r) than all: a place in it takes more
digits than a double has. So places come with the differences along the edges, which have all their digits.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe_parametrizers.elimination import solver_on

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Complexes = NDArray[np.complex128]

_CORRECTIONS = 4
_AGREED = 1e-10
_ROOMY = 1e-8  # edges no shorter than this share of the whole keep half their digits without a correction


class Layout(NamedTuple):
    """Vertices in the plane, (V,), and the differences head minus tail along the halfedges, (H,), with all digits."""

    z: Complexes
    differences: Complexes


def packed_layout(mesh: Polyhedron, angles: Floats, hole: int) -> Layout:
    """The centres of a circle packing with corner angles (H,), the corners of the hole clockwise on unit circles.

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


def harmonic_layout(mesh: Polyhedron, weights: Floats, pole: int) -> Layout:
    """The harmonic map to the plane with a simple pole in one face, conformal as the weights (H,) see it.

    The sources are a discrete derivative of the delta function (Haker et al., Conformal surface parameterization for
    texture mapping, 2000). Scale and rotation are arbitrary. A vertex of the pole is fixed: what rounding leaves of the
    sum of the sources flows to the fixed vertex, and along a limb it would drown the map of the limb.
    """
    vertices, places = _unfolded_round(mesh, pole)
    source = np.zeros(len(mesh.vertices), dtype=np.complex128)
    np.add.at(source, vertices, _dipole(places))
    return _solved(mesh, weights, vertices[:1], np.zeros_like(source), source)


def _dipole(places: Complexes) -> Complexes:
    """Least charges (6,) that have the potential of 1 / z up to the third order, seen from far away.

    Charges at the corners of a triangle alone would add a quadrupole, an error as large as the triangle.
    """
    z = places / np.abs(places).max()
    moments = np.stack([np.ones_like(z), z, z.conj(), z**2, z.conj() ** 2])
    return np.asarray(np.linalg.lstsq(moments, np.array([0, 1, 0, 0, 0], dtype=np.complex128))[0])


def _unfolded_round(mesh: Polyhedron, face: int) -> tuple[Ints, Complexes]:
    """The corners of a face and of its three neighbours (6,), and their places in its plane about its centre."""
    sides = 3 * face + np.arange(3)
    corners, p = mesh.tail[sides], mesh.vertices
    apexes = mesh.tail[mesh.next[mesh.next[mesh.twin[sides]]]]
    along = p[mesh.head[sides]] - p[corners]
    inner, inner_height = _in_frame(p[np.roll(corners, 1)] - p[corners], along)
    outer, outer_height = _in_frame(p[apexes] - p[corners], along)
    plane = np.array([0, np.linalg.norm(along[0]), inner[0] + 1j * inner_height[0]], dtype=np.complex128)
    direction = np.roll(plane, -1) - plane
    beside = plane + direction / np.abs(direction) * (outer - 1j * outer_height)
    return np.concatenate([corners, apexes]), np.concatenate([plane, beside]) - plane.mean()


def _in_frame(vectors: Floats, axis: Floats) -> tuple[Floats, Floats]:
    """The part of vectors (n, 3) along axes (n, 3) and the length of what is left."""
    unit = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    along = np.einsum("ni,ni->n", vectors, unit)
    return along, np.linalg.norm(vectors - along[:, None] * unit, axis=1)


def _solved(mesh: Polyhedron, weights: Floats, fixed: Ints, position: Complexes, source: Complexes) -> Layout:
    """The solution of sum over edges of w (z_i - z_j) = source_i at the free vertices, z = position at the fixed.

    Where edges are short against the whole, the solution is corrected by solutions for what is left of the equations.
    Each correction is smaller than the one before by all the digits of a double. So a difference of two vertices is a
    sum of differences of corrections: of near numbers, hence exact, or of far ones, which are large.
    """
    held = np.zeros(len(position), dtype=np.bool_)
    held[fixed] = True
    solve = _solver(mesh, weights, held)
    known = ~held[mesh.tail] & held[mesh.head]
    right = np.where(held, position, source)
    np.add.at(right, mesh.tail[known], weights[known] * position[mesh.head[known]])
    z = solve(right)
    differences = z[mesh.head] - z[mesh.tail]
    if not np.isfinite(z).all() or np.abs(differences).min() > _ROOMY * np.abs(z - z[0]).max():
        return Layout(z, differences)
    for _ in range(_CORRECTIONS):
        rest = np.where(held, 0, source)
        np.add.at(rest, mesh.tail, np.where(held[mesh.tail], 0, weights * differences))
        correction = solve(rest)
        change = correction[mesh.head] - correction[mesh.tail]
        z, differences = z + correction, differences + change
        if (np.abs(change) <= _AGREED * np.abs(differences)).all():
            break
    return Layout(z, differences)


def _solver(mesh: Polyhedron, weights: Floats, held: NDArray[np.bool_]) -> Callable[[Complexes], Complexes]:
    """For right sides (V,) at the free vertices, and values at those that are held, the solution (V,)."""
    i, j = mesh.tail, mesh.head
    diagonal = np.where(held, 1.0, np.bincount(i, weights=weights, minlength=len(held)))
    inner = np.flatnonzero(mesh.representative & ~held[i] & ~held[j])
    solve = solver_on(mesh, (i[inner], j[inner]), -weights[inner], diagonal)

    def solution(right: Complexes) -> Complexes:
        found = solve(np.stack([right.real, right.imag], axis=1))
        return np.asarray(found[:, 0] + 1j * found[:, 1])

    return solution
