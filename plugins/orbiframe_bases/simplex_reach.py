"""Which simplex splines may be nonzero on which triangles of X/H, through which elements of the group."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe import FitError, Points
from orbiframe.triangulations import GeodesicTriangulation, Locator

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Overlaps narrower than this are no overlaps, and lifts nearer than this are one.
_NARROW, _SAME_PLACE = 1e-12, 1e-6
# Knots must lie this far above a plane through the origin.
_LEAST_HEIGHT = 1e-6


class Reach(NamedTuple):
    """For every triangle its candidates first[f] to first[f + 1] - 1: sets of knots that may reach it.

    first: (F + 1,); knot_set: (c,), the number of the set; isometry: (c, 3, 3), from the frame of the triangle to the
    frame that the knots are in.
    """

    first: Ints
    knot_set: Ints
    isometry: Floats


def hull_bounds(domain: GeodesicTriangulation, knots: Floats) -> Floats:
    """Linear functions, (E, b, 3), not negative exactly on the cone of every set of knots (E, K, 3): its sides.

    Cones with fewer sides than b have some repeated. Raises FitError where knots lie in no open half-space: on a sphere
    with few triangles.
    """
    first, second = np.array(list(combinations(range(knots.shape[1]), 2))).T
    p, q = knots[:, first], knots[:, second]
    normal = np.cross(p, q - p)
    size = np.linalg.norm(normal, axis=2, keepdims=True)
    normal = np.divide(normal, size, out=np.zeros_like(normal), where=size > 0)
    inside = np.einsum("epi,eki->epk", normal, knots)
    left, right = (inside >= -_NARROW).all(axis=2), (inside <= _NARROW).all(axis=2)
    is_side = (left ^ right) & (size[..., 0] > 0)
    normal = np.where(left[..., None], normal, -normal)
    _require_half_spaces(domain, knots, np.where(is_side[..., None], normal, 0.0).sum(axis=1))
    order = np.argsort(~is_side, axis=1, kind="stable")[:, : is_side.sum(axis=1).max()]
    order = np.where(np.take_along_axis(is_side, order, axis=1), order, order[:, :1])
    return np.take_along_axis(normal, order[..., None], axis=1)


def _require_half_spaces(domain: GeodesicTriangulation, knots: Floats, inward: Floats) -> None:
    """Raise FitError unless the knots (E, K, 3) have a plane through the origin below them.

    inward: (E, 3), the sums of the inner normals of the sides of their cones. A cone that holds no line has its apex
    alone on all sides, so it lies above the plane of that sum; flat ones without sides lie above that of their mean.
    """
    curvature = domain.geometry.curvature
    mean = domain.geometry.project(knots.sum(axis=1)) * [1.0, curvature, curvature]
    above = [np.einsum("ei,eki->ek", n, knots).min(axis=1) > _LEAST_HEIGHT for n in (mean, inward)]
    wide = np.flatnonzero(~(above[0] | above[1]))
    if len(wide):
        raise FitError(
            f"the knots of simplex spline {wide[0]} lie in no half-space; the triangles are too large for the sphere: "
            "take more of them (option size)"
        )


def reach(locator: Locator, face: Ints, knots: Floats, bounds: Floats) -> Reach:
    """The triangles that overlap the cones of sets of knots (E, K, 3) in the frames of triangles `face` (E,).

    Found by walking from the triangle at the mean of the knots to its neighbours, as long as they overlap: a convex set
    meets a connected set of triangles.
    """
    domain = locator.domain
    level = _starts(locator, face, knots)
    found = [level]
    before = level
    while len(level[0]):
        knot_set = np.repeat(level[0], 3)
        halfedge = (3 * level[1][:, None] + np.arange(3)).ravel()
        beyond = domain.twin[halfedge] // 3
        isometry = np.repeat(level[2], 3, axis=0) @ domain.gluing[halfedge]
        overlap = _overlap(domain, beyond, isometry, knots, bounds, knot_set)
        fresh = (knot_set[overlap], beyond[overlap], isometry[overlap])
        new = _unseen(domain, (before, level), fresh)
        before, level = level, (fresh[0][new], fresh[1][new], fresh[2][new])
        found.append(level)
    knot_set, triangle, isometry = (np.concatenate(parts) for parts in zip(*found, strict=True))
    order = np.lexsort((knot_set, triangle))
    first = np.searchsorted(triangle[order], np.arange(domain.face_count + 1))
    return Reach(first, knot_set[order], np.ascontiguousarray(isometry[order]))


def _starts(locator: Locator, face: Ints, knots: Floats) -> tuple[Ints, Ints, Floats]:
    """Set, triangle at the mean of its knots, and the isometry from that triangle to the frame of the knots."""
    domain = locator.domain
    geometry = domain.geometry
    mean = geometry.act(domain.placement[face], geometry.project(knots.sum(axis=1)))
    order, triangle, columns = locator.locate(Points(domain.patch[face], mean), frames=True)
    there = columns @ geometry.inverse(geometry.carry(mean[order])) @ domain.placement[face[order]]
    return order, triangle, geometry.inverse(there)


def _overlap(
    domain: GeodesicTriangulation, face: Ints, isometry: Floats, knots: Floats, bounds: Floats, knot_set: Ints
) -> NDArray[np.bool_]:
    """Whether triangles, moved by isometries, overlap the hulls of sets of knots: no side of one has the other beyond.

    Two convex sets without a common inner point are on two sides of a side of one of them.
    """
    corners = np.einsum("nij,ncj->nci", isometry, domain.corners[face])
    outside = (np.einsum("nbi,nci->nbc", bounds[knot_set], corners).max(axis=2) <= _NARROW).any(axis=1)
    sides = np.cross(np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1))
    sides *= np.sign(np.linalg.det(corners))[:, None, None]
    beyond = (np.einsum("nsi,nki->nsk", sides, knots[knot_set]).max(axis=2) <= _NARROW).any(axis=1)
    return np.asarray(~outside & ~beyond)


def _unseen(
    domain: GeodesicTriangulation, known: tuple[tuple[Ints, Ints, Floats], ...], fresh: tuple[Ints, Ints, Floats]
) -> Ints:
    """The first of each lift among `fresh` that is not known."""
    levels = (*known, fresh)
    kind = np.concatenate([level[0] * domain.face_count + level[1] for level in levels])
    centre = domain.corners.sum(axis=1)
    place = np.concatenate([np.einsum("nij,nj->ni", level[2], centre[level[1]]) for level in levels])
    first = np.unique(same_rows(kind, place), return_index=True)[1]
    count = len(kind) - len(fresh[0])
    return np.sort(first[first >= count]) - count


def same_rows(kind: Ints, place: Floats) -> Ints:
    """A number for every row, equal where the kinds (n,) are equal and the places (n, k) are, up to rounding."""
    run = kind
    for value in place.T:
        order = np.lexsort((value, run))
        cut = (np.diff(run[order]) != 0) | (np.diff(value[order]) > _SAME_PLACE)
        number = np.empty(len(kind), dtype=np.intp)
        number[order] = np.concatenate([[0], np.cumsum(cut)])[: len(kind)]
        run = number
    return run
