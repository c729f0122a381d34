"""Border pieces: the boundary of a surface cut in about even pieces, which edges of triangles are to follow."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.delaunay.geodesic_edges import Geodesics
from orbiframe.orbifolds.atlas import Points
from orbiframe.surfaces.border_curve import BorderCurve

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

# Where the boundary turns by more it has a corner.
_CORNER = np.radians(30)
# Points of a piece, at least.
_FEWEST = 4


class BorderPieces(NamedTuple):
    """The boundary in pieces: each runs from arc length start to end, (n,), of a curve, (n,), and on to the next piece.

    following: (n,), the piece that each runs on to.
    """

    curves: list[BorderCurve]
    curve: Ints
    start: Floats
    end: Floats
    following: Ints

    @classmethod
    def of(cls, curves: list[BorderCurve], starts: list[Floats]) -> BorderPieces:
        """The pieces between arc lengths of every curve, in rising order."""
        count = np.array([len(start) for start in starts])
        first = np.cumsum(count) - count
        curve = np.repeat(np.arange(len(curves)), count)
        following = np.concatenate([a + (np.arange(n) + 1) % n for a, n in zip(first, count, strict=True)])
        ends = [np.append(s[1:], s[0] + c.length) for s, c in zip(starts, curves, strict=True)]
        return cls(curves, curve, np.concatenate(starts), np.concatenate(ends), following)

    @property
    def sites(self) -> Points:
        """Where pieces begin."""
        return self._points(self.start)

    def along(self, share: float) -> Points:
        """The points of the boundary at a share of the way along pieces."""
        return self._points((1 - share) * self.start + share * self.end)

    def _points(self, arc: Floats) -> Points:
        found = [curve.points(arc[self.curve == k]) for k, curve in enumerate(self.curves)]
        return _joined(*found)

    def geodesics(self) -> Geodesics:
        """The geodesics along pieces, between sites that are numbered as pieces are."""
        parts = [
            curve.geodesics(self.start[self.curve == k], self.end[self.curve == k])
            for k, curve in enumerate(self.curves)
        ]
        patch, start, end = (np.concatenate(table) for table in zip(*parts, strict=True))
        return Geodesics(patch, start, end, np.stack([np.arange(len(patch)), self.following], axis=1))

    def unrolled(self, piece: int) -> tuple[Floats, Floats, bool]:
        """A piece by the vertices of the refined mesh on it, in the frame of one patch: the shares of its way at which
        they lie, four at least, the points (n, 3), and whether the surface is on their left.
        """
        curve, start, end = self.curves[self.curve[piece]], float(self.start[piece]), float(self.end[piece])
        arc = np.concatenate([[start], curve.knots(start, end), [end]])
        while len(arc) < _FEWEST:
            arc = np.sort(np.concatenate([arc, (arc[:-1] + arc[1:]) / 2]))
        return (arc - start) / (end - start), curve.unrolled(start, arc)[1], curve.on_left(start)

    def halved(self, some: Bools) -> BorderPieces:
        """Some pieces, (n,), in two."""
        middle = (self.start + self.end) / 2
        starts = []
        for k in range(len(self.curves)):
            own = self.curve == k
            starts.append(np.sort(np.concatenate([self.start[own], middle[own & some]])))
        return BorderPieces.of(self.curves, starts)


def even_pieces(curves: list[BorderCurve], edge: float, apart: float, *, at_vertices: bool = False) -> BorderPieces:
    """Pieces of curves that are about as long as an edge and end at corners.

    Corners that are nearer to a sharper one than a share of the edge are none. at_vertices: all end at vertices of the
    refined mesh.
    """
    starts = [_even(curve, edge, apart) for curve in curves]
    if at_vertices:
        starts = [_snapped(curve, arc) for curve, arc in zip(curves, starts, strict=True)]
    return BorderPieces.of(curves, starts)


def _snapped(curve: BorderCurve, arc: Floats) -> Floats:
    """The vertices of the refined mesh that are nearest to arc lengths, where they are three at least."""
    knots = np.concatenate([[0.0], curve.knots(0.0, curve.length), [curve.length]])
    found = np.unique(knots[np.abs(knots[:, None] - arc).argmin(axis=0)] % curve.length)
    return found if len(found) >= 3 else arc


def _even(curve: BorderCurve, edge: float, apart: float) -> Floats:
    """Arc lengths of about even pieces between the corners of a curve, three at least in all."""
    at, turn = curve.corners(_CORNER)
    kept: list[float] = []
    for place in at[np.argsort(-turn, kind="stable")].tolist():
        away = np.abs(np.array(kept) - place)
        if not (np.minimum(away, curve.length - away) < apart * edge).any():
            kept.append(place)
    stops = np.sort(kept) if kept else np.zeros(1)
    ends = np.append(stops[1:], stops[0] + curve.length)
    number = np.maximum(np.rint((ends - stops) / edge), math.ceil(3 / len(stops))).astype(np.intp)
    shares = [a + (b - a) * np.arange(n) / n for a, b, n in zip(stops, ends, number, strict=True)]
    return np.sort(np.concatenate(shares) % curve.length)


def _joined(*points: Points) -> Points:
    return Points(*(np.concatenate(table) for table in zip(*points, strict=True)))
