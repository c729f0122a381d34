"""Parts: meshes that are moved to their places and put side by side into one polyhedron."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe_polygons.faces import offsets_of, ragged
from orbiframe_polygons.weld import welded

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Part:
    """Faces of any size with vertices of their own.

    points: (V, 3); sizes: (F,); tail: the corners of all faces; normals (V, 3) and colors (V, 3 or 4) or None;
    corner_uv: (H, 2), texture coordinates of all corners, or None.
    """

    points: Floats
    sizes: Ints
    tail: Ints
    normals: Floats | None = None
    colors: Floats | None = None
    corner_uv: Floats | None = None

    def moved(self, linear: Floats, shift: Floats) -> Part:
        """The part at its place: points times the matrix (rows) plus the shift.

        A mirroring placement turns the faces round, so that what was outside stays outside.
        """
        points = self.points @ linear + shift
        normals = None if self.normals is None else _turned_normals(self.normals, linear)
        moved = replace(self, points=points, normals=normals)
        if np.linalg.slogdet(linear)[0] >= 0:
            return moved
        corner = reversed_faces(self.sizes, np.arange(len(self.tail)))
        uv = None if self.corner_uv is None else self.corner_uv[corner]
        return replace(moved, tail=self.tail[corner], corner_uv=uv)

    def closed(self) -> Part:
        """The part with equal points joined where it has open edges without; what disagrees at a point goes."""
        if not (Polyhedron.from_corners(self.points, offsets_of(self.sizes), self.tail).twin < 0).any():
            return self
        points, place = welded(self.points[:, None])
        normals, colors = (_agreed(table, place, len(points)) for table in (self.normals, self.colors))
        return Part(points, self.sizes, place[self.tail], normals, colors, self.corner_uv)


def polyhedron_of(parts: Sequence[Part], unit: str | None = None) -> Polyhedron:
    """All parts side by side, in a unit or in none; normals, colours and textures where every part has them."""
    starts = offsets_of(np.array([len(part.points) for part in parts], dtype=np.intp))
    tail = np.concatenate([part.tail + start for part, start in zip(parts, starts[:-1], strict=True)])
    sizes = np.concatenate([part.sizes for part in parts])
    normals, colors, uv = (
        _stacked([getattr(part, name) for part in parts]) for name in ("normals", "colors", "corner_uv")
    )
    points = np.concatenate([part.points for part in parts])
    mesh = Polyhedron.from_corners(points, offsets_of(sizes), tail, normals=normals, colors=colors, unit=unit)
    return mesh if uv is None else replace(mesh, corner_uv=uv)


def reversed_faces(sizes: Ints, tail: Ints) -> Ints:
    """The corners of every face in the other order, its first corner first."""
    first = offsets_of(sizes)[:-1]
    within = ragged(np.zeros_like(sizes), sizes)
    return tail[np.repeat(first, sizes) + (np.repeat(sizes, sizes) - within) % np.repeat(sizes, sizes)]


def rotation(axis: Floats, angle: float) -> Floats:
    """The rotation about a unit axis by an angle in radians, for rows on its left (Rodrigues)."""
    x, y, z = axis.tolist()
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn: Floats = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * (cross @ cross)
    return turn.T


def _turned_normals(normals: Floats, linear: Floats) -> Floats | None:
    """Normals go by the inverse, so that they stay orthogonal; None where there is no inverse."""
    if not np.isfinite(linear).all() or np.linalg.slogdet(linear)[0] == 0:
        return None
    turned = normals @ np.linalg.inv(linear).T
    length = np.linalg.norm(turned, axis=1, keepdims=True)
    return turned / np.where(length > 0, length, 1)


def _agreed(table: Floats | None, place: Ints, count: int) -> Floats | None:
    if table is None:
        return None
    kept = np.empty((count, table.shape[1]))
    kept[place] = table
    return kept if np.allclose(kept[place], table, rtol=0, atol=1e-6) else None


def _stacked(tables: list[Floats | None]) -> Floats | None:
    found = [table for table in tables if table is not None]
    same = len(found) == len(tables) and len({table.shape[1] for table in found}) == 1
    return np.concatenate(found) if same else None
