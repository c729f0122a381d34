"""Flat: the shape of a flat torus or Klein bottle that makes the harmonic map as conformal as it can be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def with_best_lattice(flat: Triangulation, weights: Floats) -> Triangulation:
    """The harmonic map followed by the linear map that minimises its energy among those of determinant 1.

    With the frames of all patches turned alike the transitions are translations, and on the Klein bottle glides along
    one axis as well. The Gram matrix G = sum w e e^T of the lifted edges gives the map G^(-1/2), scaled; on the Klein
    bottle it must commute with the reflection, so only the two axes are scaled. The map stays harmonic.
    """
    aligned = _aligned(flat)
    edges = np.flatnonzero(aligned.polyhedron.representative)
    mesh, atlas = aligned.polyhedron, aligned.orbifold.atlas
    ends = np.einsum("eij,ej->ei", atlas.isometry[aligned.transition[edges]], aligned.points[mesh.head[edges]])
    edge = (ends - aligned.points[mesh.tail[edges]])[:, 1:]
    gram = np.einsum("e,ei,ej->ij", weights[edges], edge, edge)
    if not aligned.orbifold.orientable:
        gram = np.diag(np.diag(gram))
    values, vectors = np.linalg.eigh(gram)
    if not (values > 0).all():
        return aligned
    shape = vectors @ np.diag(values**-0.5) @ vectors.T
    shape /= np.sqrt(np.linalg.det(shape))
    return _reshaped(aligned, shape)


def _aligned(flat: Triangulation) -> Triangulation:
    """The same map with the frames of the patches turned (and reflected) so that transitions move or glide along x1."""
    orbifold = flat.orbifold
    atlas = orbifold.atlas
    turn = _frame_turns(atlas.tail, atlas.head, atlas.isometry[:, 1:, 1:], atlas.patch_count)
    if not orbifold.orientable:
        turn = _along_glide(turn, atlas.tail, atlas.head, atlas.isometry[:, 1:, 1:]) @ turn
    precise = np.tile(np.eye(3), (atlas.patch_count, 1, 1))
    precise[:, 1:, 1:] = turn
    isometry = atlas.isometry.copy()
    isometry[1:] = precise[atlas.tail[1:]] @ isometry[1:] @ np.swapaxes(precise[atlas.head[1:]], 1, 2)
    # What is left of the turning part is rounding: a diagonal matrix of signs.
    isometry[:, 1:, 1:] = np.round(isometry[:, 1:, 1:])
    points = np.einsum("vij,vj->vi", precise[flat.patch], flat.points)
    return replace(flat, orbifold=replace(orbifold, atlas=replace(atlas, isometry=isometry)), points=points)


def _frame_turns(tail: Ints, head: Ints, linear: Floats, patches: int) -> Floats:
    """For every patch the turn (2, 2) from its frame to that of patch 0, along a tree of transitions."""
    turn = np.full((patches, 2, 2), np.nan)
    turn[0] = np.eye(2)
    while np.isnan(turn).any():
        ready = np.flatnonzero(~np.isnan(turn[tail, 0, 0]) & np.isnan(turn[head, 0, 0]) & (tail >= 0))
        for t in ready:
            turn[head[t]] = turn[tail[t]] @ linear[t]
    return turn


def _along_glide(turn: Floats, tail: Ints, head: Ints, linear: Floats) -> Floats:
    """The turn (2, 2) that makes the common axis of all orientation reversing transitions the x1-axis."""
    around = turn[tail[1:]] @ linear[1:] @ np.swapaxes(turn[head[1:]], 1, 2)
    mirrors = around[np.linalg.det(around) < 0]
    angle = np.arctan2(mirrors[0, 1, 0], mirrors[0, 0, 0]) / 2
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s], [-s, c]])


def _reshaped(flat: Triangulation, shape: Floats) -> Triangulation:
    atlas = flat.orbifold.atlas
    isometry, points = atlas.isometry.copy(), flat.points.copy()
    isometry[:, 1:, 0] = isometry[:, 1:, 0] @ shape.T
    points[:, 1:] = points[:, 1:] @ shape.T
    orbifold = replace(flat.orbifold, atlas=replace(atlas, isometry=isometry))
    return replace(flat, orbifold=orbifold, points=points)
