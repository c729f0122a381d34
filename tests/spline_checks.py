"""Small domains of splines on every kind of surface, and the jumps of splines across the edges of their pieces."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
import reference_surfaces as surfaces
from orbiframe_geometries.e2 import E2
from orbiframe_geometries.h2 import H2

from orbiframe import Orbifold, Points
from orbiframe.groups import PolygonGroup, regular_polygon
from orbiframe.planes import triangle_rule
from orbiframe.splines import ElementBasis, polar
from orbiframe.triangulations import GeodesicTriangulation
from orbiframe.words.word import Word

# Where edges are looked at, as shares of their length; and a step across them, as a share of the triangle.
_SHARES = (0.137, 0.5, 0.841)
_ACROSS = 1e-5

_OCTANTS = np.array(
    [[[a, 0, 0], [0, b, 0], [0, 0, c]][:: a * b * c] for a in (1, -1) for b in (1, -1) for c in (1, -1)]
)


# ---- domains --------------------------------------------------------------------------------------------------------


def glued(orbifold: Orbifold, corners: np.ndarray, group: np.ndarray) -> GeodesicTriangulation:
    """Triangles (F, 3, 3) that fill a fundamental domain seen from patch 0, glued where an element of H joins edges.

    group: (k, 3, 3), the identity and all elements that are needed. Every triangle goes to a frame of its own.
    """
    geometry = orbifold.geometry
    ends = np.stack([corners.reshape(-1, 3), np.roll(corners, -1, axis=1).reshape(-1, 3)], axis=1)
    count = len(ends)
    twin, same, gluing = np.full(count, -1), np.zeros(count, dtype=bool), np.empty((count, 3, 3))
    for h in group:
        mirror = np.linalg.det(h) < 0
        moved = np.einsum("ij,nkj->nki", h, ends if mirror else ends[:, ::-1])
        found = (np.abs(ends[:, None] - moved[None]).max(axis=(2, 3)) < 1e-9) & (twin < 0)[:, None]
        if np.allclose(h, np.eye(3)):
            np.fill_diagonal(found, False)
        e, other = np.nonzero(found)
        twin[e], same[e], gluing[e] = other, mirror, h
    assert (twin[twin] == np.arange(count)).all()
    placement = geometry.carry(geometry.project(corners.sum(axis=1)))
    back = geometry.inverse(placement)
    face = np.arange(count) // 3
    return GeodesicTriangulation(
        orbifold,
        np.einsum("fij,fcj->fci", back, corners),
        twin,
        same,
        geometry.nearest_isometry(back[face] @ gluing @ placement[twin // 3]),
        np.zeros(len(corners), dtype=np.intp),
        placement,
    )


def polygon(word: str, *, fan: bool = True, halves: bool = False) -> GeodesicTriangulation:
    """A regular polygon glued by a word, cut into triangles from its centre, or from its first corner.

    Cut from a corner, a word with one vertex gives a triangulation with one vertex. halves: cut to the midpoints of the
    sides too.
    """
    letters = Word.parse(word)
    geometry = E2() if letters.euler_characteristic == 0 else H2()
    sides = regular_polygon(geometry, letters)
    orbifold = Orbifold(PolygonGroup(sides).atlas(), letters.euler_characteristic, letters.orientable, sides.area)
    v = sides.vertices
    if halves:
        v = np.stack([v, geometry.project(v + sides.heads)], axis=1).reshape(-1, 3)
    if fan:
        corners = np.stack([np.broadcast_to(geometry.origin, v.shape), v, np.roll(v, -1, axis=0)], axis=1)
    else:
        corners = np.array([[v[0], v[k], v[k + 1]] for k in range(1, len(v) - 1)])
    return glued(orbifold, corners, np.concatenate([np.eye(3)[None], sides.pairings]))


def sphere() -> GeodesicTriangulation:
    """The octahedron."""
    return glued(surfaces.sphere(), _OCTANTS, np.eye(3)[None])


def projective_plane() -> GeodesicTriangulation:
    """Half of the octahedron, refined once."""
    return glued(surfaces.projective_plane(), _OCTANTS[:4], np.array([np.eye(3), -np.eye(3)])).refined()


MAKERS: dict[str, Callable[[], GeodesicTriangulation]] = {
    "sphere": lambda: sphere().refined(),
    "projective plane": projective_plane,
    "torus": lambda: polygon("abAB").refined(),
    "one-vertex torus": lambda: polygon("abAB", fan=False),
    "Klein bottle": lambda: polygon("abAb").refined(),
    "Bolza": lambda: polygon("abcdABCD").refined(),
    "one-vertex Bolza": lambda: polygon("abcdABCD", fan=False),
    "three crosscaps": lambda: polygon("aabbcc").refined(),
}


@cache
def domain(name: str) -> GeodesicTriangulation:
    """One of the small domains by name, always the same object."""
    return MAKERS[name]()


def domains() -> dict[str, GeodesicTriangulation]:
    """Small domains on S^2, P^2, torus, Klein bottle, genus 2 and three crosscaps; two have one vertex."""
    return {name: domain(name) for name in MAKERS}


def quadrature(basis: ElementBasis, count: int) -> tuple[Points, np.ndarray]:
    """Points of X/H and weights that integrate smooth functions on micro triangles, with count^2 points on each.

    In the flat triangle p = sum lambda_i v_i, and dA = |det(v1, v2, v3)| / rho(p)^3 dlambda1 dlambda2.
    """
    curvature = basis.domain.geometry.curvature
    barycentric, weights = triangle_rule(count)
    flat = barycentric @ basis.micro_triangles
    rho = np.sqrt((flat**2 * [1, curvature, curvature]).sum(axis=-1))
    area = np.abs(np.linalg.det(basis.micro_triangles))[..., None] * weights / 2 / rho**3
    face = np.broadcast_to(np.arange(len(flat))[:, None, None], rho.shape).ravel()
    x = np.einsum("nij,nj->ni", basis.domain.placement[face], (flat / rho[..., None]).reshape(-1, 3))
    return Points(basis.domain.patch[face], x), area.ravel()


def random_coefficients(basis: ElementBasis, seed: int = 0) -> np.ndarray:
    """Coefficients of a function that has no reason to be smooth, (size,)."""
    return np.random.default_rng(seed).normal(size=basis.size)


# ---- jumps ----------------------------------------------------------------------------------------------------------


class Sides(NamedTuple):
    """Points of edges from both sides: triangles and micro triangles (n,), point and tangent frames (n, 3, 3)."""

    face: np.ndarray
    cell: np.ndarray
    frame: np.ndarray
    other_face: np.ndarray
    other_cell: np.ndarray
    other_frame: np.ndarray
    crossed: np.ndarray


def jumps(basis: ElementBasis, coefficients: np.ndarray, order: int, across: str = "all") -> float:
    """The largest jump of the derivatives of one order across edges of micro triangles, relative to their size.

    All derivatives of that order along X of the polynomial pieces, of the numerator where the basis divides by W, at
    points of all edges. across: 'all', 'macro' (edges between triangles of the domain, glued by the group or not) or
    'inner' (edges inside of them).
    """
    sides = both_sides(basis)
    here = _derivatives(basis, coefficients, order, sides.face, sides.cell, sides.frame)
    there = _derivatives(basis, coefficients, order, sides.other_face, sides.other_cell, sides.other_frame)
    chosen = {"all": sides.crossed | True, "macro": sides.crossed, "inner": ~sides.crossed}[across]
    return float(np.abs(here - there)[chosen].max() / np.abs(here).max())


def both_sides(basis: ElementBasis) -> Sides:
    """Some points of every edge of every micro triangle, with the micro triangle beyond."""
    d, geometry = basis.domain, basis.domain.geometry
    faces, count = basis.micro_triangles.shape[:2]
    opposite = np.concatenate([np.roll(basis.micro_triangles, 1, axis=2)] * len(_SHARES), axis=2)
    following = np.roll(basis.micro_triangles, -1, axis=2)
    on_edge = np.concatenate([(1 - t) * basis.micro_triangles + t * following for t in _SHARES], axis=2)
    beyond = (on_edge + _ACROSS * (on_edge - opposite)).reshape(-1, 3)
    frame = geometry.carry(geometry.project(on_edge.reshape(-1, 3)))
    face, cell = (a.ravel() for a in np.indices((faces, count, on_edge.shape[2]))[:2])
    height = np.einsum("nij,nj->ni", np.linalg.inv(np.swapaxes(d.corners, 1, 2))[face], beyond)
    edge = 3 * face + (height.argmin(axis=1) + 1) % 3
    crossed = height.min(axis=1) < -1e-9
    step = np.where(crossed[:, None, None], geometry.inverse(d.gluing[edge]), np.eye(3))
    other = np.where(crossed, d.twin[edge] // 3, face)
    inverse = np.linalg.inv(np.swapaxes(basis.micro_triangles, 2, 3))[other]
    heights = np.einsum("nmij,njk,nk->nmi", inverse, step, beyond).min(axis=2)
    assert (heights.max(axis=1) > -1e-9).all(), "a point beyond an edge lies in no micro triangle"
    return Sides(face, cell, frame, other, heights.argmax(axis=1), step @ frame, crossed)


def _derivatives(
    basis: ElementBasis, coefficients: np.ndarray, order: int, face: np.ndarray, cell: np.ndarray, frame: np.ndarray
) -> np.ndarray:
    """B(x, ..., x, e1, ..., e2, ...) with `order` tangent arguments, up to a factor the derivatives: (n, order + 1)."""
    coordinates = np.linalg.inv(np.swapaxes(basis.micro_triangles[face, cell], 1, 2)) @ frame
    form = basis.net(coefficients[:, None])[face, cell]
    for _ in range(basis.degree - order):
        form = polar(form, coordinates[:, :, 0])
    found = []
    for second in range(order + 1):
        rest = form
        for k in range(order):
            rest = polar(rest, coordinates[:, :, 1 + (k < second)])
        found.append(rest[:, 0, 0])
    return np.stack(found, axis=1)
