"""Meridians and parallels of a surface of genus 0, from one of its ends to the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe.planes.geometry import Geometry

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_BINS = 64
# Parallels are at most so far apart, against the way round that makes a square of them: on a round sphere it is 2.
_MOST_STRETCHED, _ROUNDS = 3.0, 20
_AT_A_POLE = 1e-12


def meridians_and_parallels(geometry: Geometry, x: Floats, places: Floats, poles: Floats) -> Floats:
    """The meridian, in turns, and the parallel, from 0 to 1, of the corners of triangles, (F, 3, 2).

    x: (F, 3, 3), the corners in S^2, where `poles` (2, 3) are some of them; places: (F, 3, 3), the same in space. A
    conformal map of the sphere takes the poles to 0 and infinity: angles there are meridians; parallels are circles
    there, as far apart as the triangles in space in the mean, so that on a round sphere they are about the latitude.
    No triangle has a leap in it: some have meridians beyond a whole turn.
    """
    north, south = (geometry.distance(x, pole) <= _AT_A_POLE for pole in poles)
    z = _conformal(geometry, x, poles)
    with np.errstate(divide="ignore"):
        height = np.log(np.abs(z))
    parallel = _parallels(height, places, north, south)
    return np.stack([_meridians(np.angle(z), north | south), parallel], axis=-1)


def _conformal(geometry: Geometry, x: Floats, poles: Floats) -> NDArray[np.complex128]:
    """A conformal coordinate that is 0 at the first pole and infinite at the second."""
    opposite = geometry.inverse(geometry.carry(-poles[1]))
    flat, zero = (_stereographic(geometry.act(opposite, points)) for points in (x, poles[:1]))
    return np.asarray(flat - zero)


def _stereographic(x: Floats) -> NDArray[np.complex128]:
    """Points of S^2 from the point opposite to the origin, without cancellation near it."""
    across = x[..., 1] ** 2 + x[..., 2] ** 2
    below = np.where(x[..., 0] > 0, 1 + x[..., 0], across / np.where(x[..., 0] > 0, 1.0, 1 - x[..., 0]))
    return np.asarray((x[..., 1] + 1j * x[..., 2]) / np.maximum(below, np.finfo(float).tiny))


def _parallels(height: Floats, places: Floats, north: Bools, south: Bools) -> Floats:
    """From 0 at the first pole to 1 at the second one, a function of the height that grows like lengths in space."""
    inner = ~(north | south).any(axis=1)
    middle, area, slope = _slopes(height[inner], places[inner])
    bounds = np.quantile(middle, np.linspace(0, 1, _BINS + 1))
    number = np.clip(np.searchsorted(bounds, middle, side="right") - 1, 0, _BINS - 1)
    areas, slopes = (np.bincount(number, weights=weight, minlength=_BINS) for weight in (area, area * slope))
    rise = _limited(np.divide(areas, slopes, out=np.zeros(_BINS), where=slopes > 0), np.diff(bounds))
    ends = [_fan(places, pole) for pole in (north, south)]
    known = height[~(north | south)]
    heights = np.concatenate([[min(known.min(), bounds[0])], bounds[1:-1], [max(known.max(), bounds[-1])]])
    lengths = ends[0] + np.concatenate([[0.0], np.cumsum(rise)])
    found = np.interp(height, heights, lengths / (lengths[-1] + ends[1]))
    return np.asarray(np.where(north, 0.0, np.where(south, 1.0, found)))


def _limited(rate: Floats, height: Floats) -> Floats:
    """The lengths of the bins, without those of thin limbs, along which the height hardly grows."""
    most = max(_MOST_STRETCHED / (2 * np.pi), 1.5 / height.sum())
    for _ in range(_ROUNDS):
        rate = np.minimum(rate, most * (rate @ height))
    return np.asarray(rate * height)


def _slopes(height: Floats, places: Floats) -> tuple[Floats, Floats, Floats]:
    """The mean height of triangles, their area, and how steeply the height grows in space."""
    u, v = places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]
    a, b = height[:, 1] - height[:, 0], height[:, 2] - height[:, 0]
    uu, uv, vv = (np.einsum("fi,fi->f", p, q) for p, q in ((u, u), (u, v), (v, v)))
    square = np.maximum(uu * vv - uv**2, 0.0)
    area = np.sqrt(square) / 2
    with np.errstate(all="ignore"):
        slope = np.sqrt(np.maximum(vv * a * a - 2 * uv * a * b + uu * b * b, 0.0) / square)
    good = np.isfinite(slope)
    return height.mean(axis=1)[good], area[good], slope[good]


def _fan(places: Floats, pole: Bools) -> float:
    """How far in space the neighbours of a pole are from it, in the mean."""
    face, corner = np.nonzero(pole)
    other = places[face, (corner + 1) % 3]
    return float(np.linalg.norm(other - places[face, corner], axis=1).mean())


def _meridians(angle: Floats, pole: Bools) -> Floats:
    """Angles of the corners of triangles in turns, without a leap in a triangle; poles lie amid the other corners."""
    base = np.take_along_axis(angle, np.argmin(pole, axis=1)[:, None], axis=1)
    turns = np.where(pole, 0.0, (angle - base + np.pi) % (2 * np.pi) - np.pi) / (2 * np.pi)
    others = turns.sum(axis=1, keepdims=True) / (~pole).sum(axis=1, keepdims=True)
    turns = np.where(pole, others, turns) + base / (2 * np.pi)
    return np.asarray(turns - np.floor(turns.mean(axis=1, keepdims=True)))
