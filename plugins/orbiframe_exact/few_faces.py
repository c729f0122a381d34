"""Few faces: a smooth surface as a few polynomial B-spline faces with common edges and tangent planes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from orbiframe_exact.complete_spline import (
    abscissae,
    bisected,
    data,
    evaluate,
    evaluate_grid,
    graded,
    holding,
    operator,
    sharing,
)
from orbiframe_exact.quad_domain import QuadDomain
from orbiframe_exact.quad_places import places_in_quads

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_ROUNDS = 10
# No interval holds more of the area of a face than this at first; and one is halved so often at most for that.
_SHARE, _HALVINGS = 0.4, 40
# A face has so many intervals in each direction at most.
_MOST_INTERVALS = 250
# Edges are so much nearer to the surface than faces: a coarse edge lets the angle refine the faces in vain.
_EDGE_SHARE = 0.15
ANGLE = 0.1  # degrees between the tangent planes of neighbours
# What is asked for where intervals are looked at: between those points it may be a little more.
_ASKED = 0.85 * ANGLE
_WITHIN = np.linspace(0.0625, 0.9375, 8)  # where an interval is looked at


@dataclass(eq=False)
class FewFaces:
    """Faces under way: breaks and control points of edges and faces; `fitted` makes them.

    tolerance: the largest distance from the surface, in its units before it is placed; edge_breaks and edge_poles: of
    every edge; own_breaks: of every face, in s and t, beside those of its edges; faces: the breaks and poles of every
    face; error: (Q,), the largest distance found on each; angle: (E,), between its faces in degrees.
    """

    domain: QuadDomain
    tolerance: float
    edge_breaks: list[Floats] = field(default_factory=list)
    edge_poles: dict[int, Floats] = field(default_factory=dict)
    own_breaks: list[list[Floats]] = field(default_factory=list)
    faces: dict[int, tuple[tuple[Floats, Floats], Floats]] = field(default_factory=dict)
    error: dict[int, float] = field(default_factory=dict)
    angle: Floats = field(default_factory=lambda: np.zeros(0))
    worst: Floats = field(default_factory=lambda: np.zeros(3))

    intervals: ClassVar[int] = 4

    def __post_init__(self) -> None:
        """Begin with few intervals everywhere."""
        even = np.linspace(0, 1, self.intervals + 1)
        self.edge_breaks = [even] * len(self.domain.ends)
        self.own_breaks = [[even, even] for _ in range(self.domain.count)]
        self._divide_limbs()
        self.sides = self.domain.sides_of_edges()

    def fit(self) -> None:
        """Fit edges, then faces, and halve intervals where they are not near or not smooth enough, 10 times at most."""
        edges: list[int] = list(range(len(self.edge_breaks)))
        for _ in range(_ROUNDS):
            self._fit_edges(edges)
            edges = self._coarse_edges(edges)
            if not edges:
                break
        self._fit_edges(edges)
        faces = set(range(self.domain.count))
        for _ in range(_ROUNDS):
            self._fit_faces(sorted(faces))
            faces = self._coarse_faces(sorted(faces)) | self._rough_faces()
            if not faces:
                return

    def _divide_limbs(self) -> None:
        """Put breaks where a face holds much of the surface in a small part of its square, as a limb within it."""
        if not self.domain.closed:
            return
        quad, s, t, area = places_in_quads(self.domain)
        for q in range(self.domain.count):
            for axis, at in enumerate((s[quad == q], t[quad == q])):
                breaks = sharing(at, area[quad == q], _SHARE, _HALVINGS)
                self.own_breaks[q][axis] = graded(np.union1d(self.own_breaks[q][axis], breaks))

    # ---- edges ------------------------------------------------------------------------------------------------------

    def along(self, side: int, u: Floats) -> tuple[Floats, Floats]:
        """The parameters s and t of a side 4 q + k at parameters of its edge."""
        quad, k = divmod(side, 4)
        w = u if self.domain.rising[quad, k] else 1 - u
        fixed = np.full_like(w, float(k in (1, 2)))
        return (w, fixed) if k % 2 == 0 else (fixed, w)

    def _on_edges(self, edges: Iterable[int], at: list[Floats], order: int) -> list[Floats]:
        """The surface at parameters of edges; for order 1 also the derivative along each."""
        first = [int(self.sides[e, 0]) for e in edges]
        places = [self.along(side, u) for side, u in zip(first, at, strict=True)]
        quad = np.repeat([side // 4 for side in first], [len(u) for u in at])
        s, t = (np.concatenate([place[k] for place in places]) for k in (0, 1))
        found = self.domain.points.jets(quad, s, t, order)
        if not order:
            return found
        sign = np.repeat([1.0 if self.domain.rising[divmod(x, 4)] else -1.0 for x in first], [len(u) for u in at])
        across = np.repeat([side % 2 for side in first], [len(u) for u in at])
        return [found[0], np.where(across[:, None], found[2], found[1]) * sign[:, None]]

    def _fit_edges(self, edges: list[int]) -> None:
        if not edges:
            return
        at = [abscissae(self.edge_breaks[e]) for e in edges]
        values, slopes = (_split(found, at) for found in self._on_edges(edges, at, 1))
        for e, f, d in zip(edges, values, slopes, strict=True):
            self.edge_poles[e] = np.asarray(
                np.linalg.solve(operator(self.edge_breaks[e]), data(f, d)), dtype=np.float64
            )

    def _coarse_edges(self, edges: list[int]) -> list[int]:
        """The edges that are too far from the surface; the intervals where they are are halved."""
        at = [_within(self.edge_breaks[e]) for e in edges]
        found = []
        for e, u, f in zip(edges, at, _split(self._on_edges(edges, at, 0)[0], at), strict=True):
            gap = np.linalg.norm(evaluate(self.edge_breaks[e], self.edge_poles[e], u) - f, axis=1)
            far = gap.reshape(-1, len(_WITHIN)).max(axis=1) > _EDGE_SHARE * self.tolerance
            if far.any():
                self.edge_breaks[e] = bisected(self.edge_breaks[e], far)
                found.append(e)
        return found

    # ---- faces ------------------------------------------------------------------------------------------------------

    def _breaks(self, quad: int) -> tuple[Floats, Floats]:
        """The breaks of a face: its own and those of both edges on either side."""
        found = [[self.own_breaks[quad][axis]] for axis in (0, 1)]
        for k in range(4):
            breaks = self.edge_breaks[self.domain.edge[quad, k]]
            found[k % 2].append(breaks if self.domain.rising[quad, k] else 1 - breaks[::-1])
        s, t = (np.unique(np.concatenate(parts)) for parts in found)
        return s, t

    def _fit_faces(self, quads: list[int]) -> None:
        """Faces by values at their sites; at their borders the edges, and derivatives across in the common planes."""
        breaks = [self._breaks(q) for q in quads]
        at = [(abscissae(s), abscissae(t)) for s, t in breaks]
        inside = _split(self._on_grids(quads, at), [np.empty(len(s) * len(t)) for s, t in at])
        rims = [[s, t, s, t] for s, t in at]
        quad = np.concatenate([np.full(len(u), q) for q, rim in zip(quads, rims, strict=True) for u in rim])
        flat = [u for rim in rims for u in rim]
        places = [_border(k % 4, u) for k, u in enumerate(flat)]
        all_s, all_t = (np.concatenate([place[i] for place in places]) for i in (0, 1))
        jets = self.domain.points.jets(quad, all_s, all_t, 1)
        normal = _split(self._border_normals(quads, flat, unit(np.cross(jets[1], jets[2]))), flat)
        border = [_split(found, flat) for found in jets]
        corner = np.tile([0.0, 1, 1, 0], len(quads)), np.tile([0.0, 0, 1, 1], len(quads))
        twists = self.domain.points.jets(np.repeat(quads, 4), *corner, 2)[3].reshape(-1, 4, 3)
        for n, q in enumerate(quads):
            four = [(border[2 - k % 2][4 * n + k], normal[4 * n + k]) for k in range(4)]
            self.faces[q] = breaks[n], self._face(q, breaks[n], inside[n], four, twists[n])

    def _on_grids(self, quads: list[int], at: list[tuple[Floats, Floats]]) -> Floats:
        quad = np.repeat(quads, [len(s) * len(t) for s, t in at])
        s = np.concatenate([np.repeat(s, len(t)) for s, t in at])
        t = np.concatenate([np.tile(t, len(s)) for s, t in at])
        return self.domain.points.jets(quad, s, t, 0)[0]

    def _face(
        self,
        quad: int,
        breaks: tuple[Floats, Floats],
        inside: Floats,
        border: list[tuple[Floats, Floats]],
        twist: Floats,
    ) -> Floats:
        """The control points of a face (n_s, n_t, 3).

        What differs from plain interpolation: derivatives across a border lose their part along m, which is the normal
        of the surface made orthogonal to the edge curve. So both neighbours touch the same planes at their sites, and
        the angle between them is as small as the error of a spline.
        """
        operators = [operator(b) for b in breaks]
        rows, columns = (len(a) for a in operators)
        wanted, poles = np.zeros((rows, columns, 3)), np.zeros((rows, columns, 3))
        keep = [np.concatenate([[0], np.arange(2, n - 2), [n - 1]]) for n in (rows, columns)]
        wanted[np.ix_(*keep)] = inside.reshape(rows - 2, columns - 2, 3)
        for k in range(4):
            edge, tangent, across = self._rim(quad, k, breaks[k % 2], border[k])
            outer, inner = ((0, 1), (-1, -2))[k in (1, 2)]
            line = np.linalg.solve(operators[k % 2], data(edge, tangent))
            if k % 2 == 0:
                poles[:, outer], wanted[2:-2, inner] = line, across[1:-1]
            else:
                poles[outer], wanted[inner, 2:-2] = line, across[1:-1]
        for (i, j), value in zip(((1, 1), (-2, 1), (-2, -2), (1, -2)), twist, strict=True):
            wanted[i, j] = value
        left = wanted - np.einsum("ai,ijk,bj->abk", operators[0], poles, operators[1], optimize=True)
        poles[1:-1, 1:-1] = _solved(operators, left[1:-1, 1:-1])
        return poles

    def _rim(self, quad: int, k: int, breaks: Floats, border: tuple[Floats, Floats]) -> tuple[Floats, Floats, Floats]:
        """The edge curve at a side, its tangent, and the derivative of the surface across it, in the common planes."""
        edge, rising = self.domain.edge[quad, k], self.domain.rising[quad, k]
        u = abscissae(breaks) if rising else 1 - abscissae(breaks)
        curve, tangent = (evaluate(self.edge_breaks[edge], self.edge_poles[edge], u, nu) for nu in (0, 1))
        tangent = tangent if rising else -tangent
        across, normal = border
        m = unit(normal - tangent * (dot(normal, tangent) / dot(tangent, tangent)))
        return curve, tangent, across - m * dot(across, m)

    def _border_normals(self, quads: list[int], at: list[Floats], own: Floats) -> Floats:  # noqa: ARG002
        """The normals that both faces have in common at places of the borders of faces, from those of the surface."""
        return own

    def _coarse_faces(self, quads: list[int]) -> set[int]:
        """The faces that are too far from the surface; the intervals where they are are halved."""
        grids: list[tuple[Floats, Floats]] = []
        for q in quads:
            s, t = self.faces[q][0]
            grids += [(_middles(s), t[1:-1]), (s[1:-1], _middles(t))]
        places = _split(
            self._on_grids([q for q in quads for _ in (0, 1)], grids), [np.empty(len(s) * len(t)) for s, t in grids]
        )
        found = set()
        for n, q in enumerate(quads):
            breaks, poles = self.faces[q]
            self.error[q] = 0.0
            for axis in (0, 1):
                grid, wanted = grids[2 * n + axis], places[2 * n + axis]
                gap = np.linalg.norm(evaluate_grid(breaks, poles, *grid, (0, 0)).reshape(-1, 3) - wanted, axis=1)
                worst = gap.reshape(len(grid[0]), len(grid[1])).max(axis=1 - axis)
                self.error[q] = max(self.error[q], float(worst.max()))
                if (worst > self.tolerance).any() and len(breaks[axis]) <= _MOST_INTERVALS:
                    self.own_breaks[q][axis] = bisected(breaks[axis], worst > self.tolerance)
                    found.add(q)
        return found

    def _rough_faces(self) -> set[int]:
        """Faces whose tangent planes differ from those of a neighbour; the intervals along the edge are halved."""
        found, angles, worst = set(), np.zeros(len(self.sides)), np.full(len(self.sides), 0.5)
        for e in np.flatnonzero(self.domain.smooth).tolist():
            sides = [side for side in self.sides[e].tolist() if side >= 0]
            u = _within(np.unique(np.concatenate([self._along_edge(side) for side in sides])))
            one, other = self._both_normals(e, sides, u)
            sine, cosine = np.linalg.norm(np.cross(one, other), axis=1), np.abs(dot(one, other))[:, 0]
            angle = np.degrees(np.arctan2(sine, cosine))
            angles[e] = angle.max()
            worst[e] = u[angle.argmax()]
            for side in sides if angle.max() > _ASKED else ():
                quad, k = divmod(side, 4)
                at = self.along(side, u[angle > _ASKED])[k % 2]
                breaks = self.faces[quad][0][k % 2]
                if len(breaks) > _MOST_INTERVALS:
                    continue
                mended = bisected(breaks, holding(breaks, at))
                self.own_breaks[quad][k % 2] = np.union1d(self.own_breaks[quad][k % 2], mended)
                found.add(quad)
        self.angle = angles
        e = int(angles.argmax())
        self.worst = evaluate(self.edge_breaks[e], self.edge_poles[e], worst[[e]])[0]
        return found

    def _both_normals(self, edge: int, sides: list[int], u: Floats) -> tuple[Floats, Floats]:  # noqa: ARG002
        """The normals of both faces at an edge."""
        return self._normals(sides[0], u), self._normals(sides[1], u)

    def _along_edge(self, side: int) -> Floats:
        """The breaks of a face along a side, as parameters of the edge."""
        quad, k = divmod(side, 4)
        breaks = self.faces[quad][0][k % 2]
        return breaks if self.domain.rising[quad, k] else 1 - breaks[::-1]

    def _normals(self, side: int, u: Floats) -> Floats:
        s, t = self.along(side, u)
        grid = (s, t[:1]) if side % 2 == 0 else (s[:1], t)
        breaks, poles = self.faces[side // 4]
        d = [evaluate_grid(breaks, poles, *grid, nu).reshape(-1, 3) for nu in ((1, 0), (0, 1))]
        return unit(np.cross(d[0], d[1]))


# ---- small things ---------------------------------------------------------------------------------------------------


def _split(rows: Floats, like: list[Floats]) -> list[Floats]:
    return np.split(rows, np.cumsum([len(u) for u in like])[:-1])


def _within(breaks: Floats) -> Floats:
    return np.asarray((breaks[:-1, None] + np.diff(breaks)[:, None] * _WITHIN).ravel())


def _middles(breaks: Floats) -> Floats:
    return np.asarray((breaks[:-1] + breaks[1:]) / 2)


def _border(k: int, u: Floats) -> tuple[Floats, Floats]:
    fixed = np.full_like(u, float(k in (1, 2)))
    return (u, fixed) if k % 2 == 0 else (fixed, u)


def _solved(operators: list[Floats], left: Floats) -> Floats:
    """Inner control points of a tensor product from its inner data."""
    rows, columns = left.shape[:2]
    half = np.linalg.solve(operators[0][1:-1, 1:-1], left.reshape(rows, -1)).reshape(left.shape)
    turned = np.swapaxes(half, 0, 1).reshape(columns, -1)
    return np.swapaxes(np.linalg.solve(operators[1][1:-1, 1:-1], turned).reshape(columns, rows, 3), 0, 1)


def dot(a: Floats, b: Floats) -> Floats:
    """The scalar products of vectors (n, 3), (n, 1)."""
    return np.asarray(np.einsum("ni,ni->n", a, b)[:, None])


def unit(vectors: Floats) -> Floats:
    """Vectors (n, 3) over their lengths."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, np.finfo(float).tiny))
