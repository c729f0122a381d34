"""Open shapes: meshes with a boundary for tests and measurements, all made here and the same on every machine."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from orbiframe import Polyhedron
from orbiframe.meshes import without_unused_vertices

Floats = NDArray[np.float64]

TAU = 2 * np.pi


def bumpy_disc(rings: int = 12) -> Polyhedron:
    """A round disc with bumps; ring k has 6k vertices."""
    radius = np.concatenate([[0.0], *(np.full(6 * k, k / rings) for k in range(1, rings + 1))])
    angle = np.concatenate([[0.0], *(TAU * np.arange(6 * k) / (6 * k) for k in range(1, rings + 1))])
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    points = np.stack([x, y, 0.15 * np.sin(4 * x) * np.cos(3 * y)], axis=1)
    first = [0, *(1 + 3 * k * (k - 1) for k in range(1, rings + 1))]
    faces = [[0, 1 + k, 1 + (k + 1) % 6] for k in range(6)]
    for k in range(1, rings):
        inner, outer = first[k], first[k + 1]
        for side in range(6):
            for j in range(k + 1):
                a, b = outer + (side * (k + 1) + j) % (6 * k + 6), outer + (side * (k + 1) + j + 1) % (6 * k + 6)
                faces.append([inner + (side * k + j) % (6 * k), a, b])
                if j < k:
                    faces.append([inner + (side * k + j) % (6 * k), b, inner + (side * k + j + 1) % (6 * k)])
    return Polyhedron.from_faces(points, faces)


def grid(
    n: int, m: int, place: Callable[[Floats, Floats], Floats], glued: tuple[bool, bool] = (False, False)
) -> Polyhedron:
    """Quadrilaterals on n x m places of the unit square, glued around in either direction or not."""
    rows, columns = n + (not glued[0]), m + (not glued[1])
    u, v = np.meshgrid(np.arange(rows) / n, np.arange(columns) / m, indexing="ij")
    i, j = (part.ravel() for part in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    ahead, across = (i + 1) % rows, (j + 1) % columns
    corners = [i * columns + j, ahead * columns + j, ahead * columns + across, i * columns + across]
    return Polyhedron.from_faces(place(u.ravel(), v.ravel()), np.stack(corners, axis=1))


def square_sheet(n: int = 16) -> Polyhedron:
    """A square with four corners, waved."""
    return grid(n, n, lambda u, v: np.stack([u, v, 0.08 * np.sin(5 * u) * np.cos(4 * v)], axis=1))


def cylinder(n: int = 32, m: int = 16, height: float = 2.0) -> Polyhedron:
    """A round cylinder of radius 1 without its ends."""
    return grid(n, m, lambda u, v: np.stack([np.cos(TAU * u), np.sin(TAU * u), height * v], axis=1), (True, False))


def moebius_band(n: int = 48, m: int = 8, width: float = 0.8) -> Polyhedron:
    """A band with half a twist."""
    angle, across = np.meshgrid(TAU * np.arange(n) / n, width * (np.arange(m + 1) / m - 0.5), indexing="ij")
    radius = 1 + across * np.cos(angle / 2)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), across * np.sin(angle / 2)], axis=-1)

    def place(i: int, j: int) -> int:
        return i * (m + 1) + j if i < n else m - j

    faces = [[place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)] for i in range(n) for j in range(m)]
    return Polyhedron.from_faces(points.reshape(-1, 3), faces)


def torus_with_hole(n: int = 40, m: int = 20) -> Polyhedron:
    """A torus of which the quadrilaterals inside of a wavy curve are gone, so that the hole has steps."""

    def place(u: Floats, v: Floats) -> Floats:
        radius = 1 + 0.4 * np.cos(TAU * v)
        return np.stack([radius * np.cos(TAU * u), radius * np.sin(TAU * u), 0.4 * np.sin(TAU * v)], axis=1)

    mesh = grid(n, m, place, (True, True))
    u, v = np.divmod(np.arange(n * m), m)
    x, y = (u + 0.5) / n - 0.5, (v + 0.5) / m - 0.5
    return _without(mesh, np.hypot(x, y / 2) < 0.12 * (1 + 0.25 * np.cos(5 * np.arctan2(y / 2, x))))


def mask(n: int = 28) -> Polyhedron:
    """Half an egg with two eyes and a mouth, holes with steps."""

    def place(u: Floats, v: Floats) -> Floats:
        x, y = 2 * u - 1, 2 * v - 1
        # The square becomes a disc (Fong, 2015), the disc a dome with a nose.
        a, b = x * np.sqrt(1 - y**2 / 2), y * np.sqrt(1 - x**2 / 2)
        nose = 0.2 * np.exp(-((a / 0.2) ** 2) - ((b / 0.35) ** 2))
        return np.stack([0.8 * a, 1.1 * b, 0.6 * np.sqrt(np.maximum(1.1 - a**2 - b**2, 0)) + nose], axis=1)

    mesh = grid(n, n, place)
    middle = mesh.vertices[mesh.tail.reshape(-1, 4)].mean(axis=1)
    x, y = middle[:, 0], middle[:, 1]
    eyes = np.hypot((np.abs(x) - 0.32) / 0.16, (y - 0.3) / 0.11) < 1
    mouth = np.hypot(x / 0.3, (y + 0.5) / 0.1) < 1
    return _without(mesh, eyes | mouth)


def _without(mesh: Polyhedron, gone: NDArray[np.bool_]) -> Polyhedron:
    corners = mesh.tail.reshape(-1, 4)[~gone]
    return without_unused_vertices(Polyhedron.from_faces(mesh.vertices, corners))


SHAPES: dict[str, Callable[[], Polyhedron]] = {
    "bumpy disc": bumpy_disc,
    "square sheet": square_sheet,
    "cylinder": cylinder,
    "Möbius band": moebius_band,
    "torus with a jagged hole": torus_with_hole,
    "mask with three holes": mask,
}
