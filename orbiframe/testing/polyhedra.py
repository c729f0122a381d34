"""Small closed polyhedra that every law may be tried on."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from orbiframe.meshes.polyhedron import Polyhedron


def reference_polyhedra() -> Mapping[str, Polyhedron]:
    """Closed polyhedra by name: triangles, quads, larger faces; Euler characteristics of each sign; one-sided ones."""
    return {
        "tetrahedron": _tetrahedron(),
        "cube": _cube(),
        "prism": _prism(5),
        "torus": _seven_vertex_torus(),
        "double torus": _double_torus(),
        "projective plane": _six_vertex_projective_plane(),
        "Klein bottle": _klein_bottle(8, 5),
    }


def _tetrahedron() -> Polyhedron:
    corners = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
    return Polyhedron.from_faces(corners, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])


def _cube() -> Polyhedron:
    corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Polyhedron.from_faces(corners, faces)


def _prism(sides: int) -> Polyhedron:
    """A prism: two polygons and a ring of quads."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=1)
    walls = [[i, (i + 1) % sides, (i + 1) % sides + sides, i + sides] for i in range(sides)]
    lids = [list(range(sides))[::-1], list(range(sides, 2 * sides))]
    return Polyhedron.from_faces(np.concatenate([ring, ring + np.array([0, 0, 1.5])]), [*lids, *walls])


def _seven_vertex_torus() -> Polyhedron:
    """The torus of Möbius on 7 vertices, embedded after Császár (1949): every two vertices share an edge."""
    vertices = [[3, -3, 0], [3, 3, 1], [1, 2, 3], [-1, -2, 3], [-3, -3, 1], [-3, 3, 0], [0, 0, 15]]
    faces = ["012", "610", "024", "530", "036", "045", "521", "431", "135", "641", "234", "632", "256", "654"]
    return Polyhedron.from_faces(vertices, [[int(corner) for corner in face] for face in faces])


def _six_vertex_projective_plane() -> Polyhedron:
    """The projective plane on 6 vertices: the icosahedron with opposite vertices identified (no embedding exists)."""
    vertices = np.array([[0.0, 0.0, 1.0], [1, 0, 0], [0.3, 1, 0], [-0.8, 0.6, 0.2], [-0.8, -0.6, -0.3], [0.3, -1, 0.1]])
    cap = [[0, i, i % 5 + 1] for i in range(1, 6)]
    rim = [[i, i % 5 + 1, (i + 2) % 5 + 1] for i in range(1, 6)]
    return Polyhedron.from_faces(vertices, cap + rim)


def _klein_bottle(along: int, across: int) -> Polyhedron:
    """A grid of quads whose ends are glued with a turn, as the immersed bottle that is a twisted figure eight."""
    u, v = np.meshgrid(np.arange(along) / along, np.arange(across) / across, indexing="ij")
    half, turn = np.pi * u, 2 * np.pi * v
    eight = np.cos(half) * np.sin(turn) - np.sin(half) * np.sin(2 * turn)
    lift = np.sin(half) * np.sin(turn) + np.cos(half) * np.sin(2 * turn)
    vertices = np.stack([(2 + eight) * np.cos(2 * half), (2 + eight) * np.sin(2 * half), lift], axis=-1)

    def corner(i: int, j: int) -> int:
        return i * across + j % across if i < along else -j % across

    squares = [(i, j) for i in range(along) for j in range(across)]
    faces = [[corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)] for i, j in squares]
    return Polyhedron.from_faces(vertices.reshape(-1, 3), faces)


def _double_torus() -> Polyhedron:
    """A plate of unit cubes, five by three, with two of them left out: the sphere with two handles."""
    squares = {(i, j) for i in range(5) for j in range(3)} - {(1, 1), (3, 1)}
    quads = [
        [(i, j, z), (i + 1, j, z), (i + 1, j + 1, z), (i, j + 1, z)][:: 2 * z - 1] for i, j in squares for z in (0, 1)
    ]
    for i, j in sorted(squares):
        ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
        for side, step in enumerate([(0, -1), (1, 0), (0, 1), (-1, 0)]):
            if (i + step[0], j + step[1]) not in squares:
                a, b = ring[side], ring[(side + 1) % 4]
                quads.append([(*a, 0), (*b, 0), (*b, 1), (*a, 1)])
    corners = sorted({corner for quad in quads for corner in quad})
    number = {corner: index for index, corner in enumerate(corners)}
    return Polyhedron.from_faces(np.array(corners, dtype=float), [[number[c] for c in quad] for quad in sorted(quads)])
