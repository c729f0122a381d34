"""Make the meshes of this folder and their index: `python datasets/make.py [FOLDER]`.

Every mesh is a pair of vertices (V, 3) and faces, lists of vertex indices. Nothing is random and coordinates are
rounded to nine digits, so the files are the same bytes on every machine.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from itertools import combinations, pairwise, product
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Faces = list[list[int]]
Mesh = tuple[Floats, Faces]

TAU = 2 * np.pi


class Entry(NamedTuple):
    """One line of the index: how a mesh is made and which surface it is."""

    surface: str
    orientable: bool
    genus: int
    make: Callable[[], Mesh]


def icosahedron() -> Mesh:
    """The regular icosahedron in the unit sphere, faces seen counterclockwise from outside."""
    golden = (1 + np.sqrt(5)) / 2
    signs = list(product((-1, 1), (-golden, golden)))
    corners = np.array([np.roll([0, a, b], k) for k in range(3) for a, b in signs]) / np.hypot(1, golden)
    near = np.linalg.norm(corners[:, None] - corners, axis=2) < 1.1
    triples = [t for t in combinations(range(12), 3) if near[np.ix_(t, t)].all()]
    return corners, [_outward(corners, triple) for triple in triples]


def _outward(vertices: Floats, triple: Sequence[int]) -> list[int]:
    i, j, k = triple
    return [i, j, k] if np.linalg.det(vertices[[i, j, k]]) > 0 else [i, k, j]


def icosphere(rounds: int) -> Mesh:
    """Every triangle of the icosahedron in four, as often as `rounds` says, on the unit sphere."""
    vertices, faces = icosahedron()
    for _ in range(rounds):
        vertices, faces = _in_four(vertices, faces)
    return _on_sphere(vertices), faces


def _in_four(vertices: Floats, triangles: Faces) -> Mesh:
    points = list(vertices)
    middle: dict[tuple[int, int], int] = {}

    def between(i: int, j: int) -> int:
        key = (min(i, j), max(i, j))
        if key not in middle:
            middle[key] = len(points)
            points.append((points[i] + points[j]) / 2)
        return middle[key]

    faces = []
    for i, j, k in triangles:
        a, b, c = between(i, j), between(j, k), between(k, i)
        faces += [[i, a, c], [a, j, b], [c, b, k], [a, b, c]]
    return np.array(points), faces


def dodecahedron() -> Mesh:
    """The regular dodecahedron, dual of the icosahedron: twelve pentagons."""
    corners, triangles = icosahedron()
    centres = np.array([corners[triangle].sum(axis=0) for triangle in triangles])
    return _on_sphere(centres), [_around(i, triangles) for i in range(len(corners))]


def _around(vertex: int, triangles: Faces) -> list[int]:
    """The triangles about a vertex, counterclockwise: each is followed by the one that has its last edge first."""
    first = {_turned(t, vertex)[1]: (f, _turned(t, vertex)[2]) for f, t in enumerate(triangles) if vertex in t}
    ring, at = [], next(iter(first))
    for _ in first:
        face, at = first[at]
        ring.append(face)
    return ring


def _turned(triangle: list[int], vertex: int) -> list[int]:
    start = triangle.index(vertex)
    return triangle[start:] + triangle[:start]


def cube() -> Mesh:
    """The unit cube: six quads."""
    return plate(1, 1)


def plate(length: int, width: int, holes: Iterable[tuple[int, int]] = (), parts: int = 1) -> Mesh:
    """Unit cubes in a plate of height 1 without those at `holes`; every square in `parts` times `parts`.

    Each hole is a handle, if no two of them touch and none lies on the rim.
    """
    cubes = {(x, y, 0) for x in range(length) for y in range(width)} - {(x, y, 0) for x, y in holes}
    squares = [square for cube in sorted(cubes) for square in _free_squares(cube, cubes)]
    return _merged([small for square in squares for small in _split(square, parts)])


def _free_squares(cube: tuple[int, int, int], cubes: set[tuple[int, int, int]]) -> list[Floats]:
    """The squares of a cube that no other cube covers, each with four corners (4, 3) seen from outside."""
    found = []
    for axis, side in product(range(3), (0, 1)):
        step = np.roll([2 * side - 1, 0, 0], axis)
        if tuple(np.add(cube, step).tolist()) not in cubes:
            corners = [(side, 0, 0), (side, 1, 0), (side, 1, 1), (side, 0, 1)]
            square = np.array([np.roll(c, axis) for c in corners], dtype=float) + cube
            found.append(square if side else square[::-1])
    return found


def _split(square: Floats, parts: int) -> list[Floats]:
    origin, u, v = square[0], (square[1] - square[0]) / parts, (square[3] - square[0]) / parts
    return [
        np.array([origin + i * u + j * v for i, j in ((a, b), (a + 1, b), (a + 1, b + 1), (a, b + 1))])
        for a, b in product(range(parts), repeat=2)
    ]


def _merged(polygons: Sequence[Floats]) -> Mesh:
    """Polygons in space with equal corners made one vertex, numbered in the order in which they are met."""
    number: dict[tuple[float, ...], int] = {}
    faces = [[number.setdefault(tuple(np.round(c, 9).tolist()), len(number)) for c in p] for p in polygons]
    return np.array(list(number)), faces


def torus(around: int, across: int) -> Mesh:
    """A circle of radius 0.4 turned about an axis in the distance 1: quads."""
    u, v = TAU * np.arange(around)[:, None] / around, TAU * np.arange(across) / across
    r, z = 1 + 0.4 * np.cos(v), 0.4 * np.sin(v) + 0 * u
    vertices = np.stack([r * np.cos(u), r * np.sin(u), z], axis=2).reshape(-1, 3)
    return vertices, _quads(around, across, lambda i, j: i % around * across + j)


def klein_bottle(around: int, across: int) -> Mesh:
    """A figure eight turned about an axis, and over by half a turn on the way: quads.

    Vertices lie half a step beside the crossing of the eight, so that no two of them coincide.
    """
    u, v = TAU * np.arange(around)[:, None] / around, TAU * (np.arange(across) + 0.5) / across
    r = 2 + np.cos(u / 2) * np.sin(v) - np.sin(u / 2) * np.sin(2 * v)
    z = np.sin(u / 2) * np.sin(v) + np.cos(u / 2) * np.sin(2 * v)
    vertices = np.stack([r * np.cos(u), r * np.sin(u), z], axis=2).reshape(-1, 3)

    def index(i: int, j: int) -> int:
        return i * across + j if i < around else across - 1 - j

    return vertices, _quads(around, across, index)


def _quads(around: int, across: int, index: Callable[[int, int], int]) -> Faces:
    """The quads of a grid that closes both ways; index(i, j) is a vertex, with 0 <= i <= around, 0 <= j < across."""
    cells = [(i, j, (j + 1) % across) for i, j in product(range(around), range(across))]
    return [[index(i, j), index(i + 1, j), index(i + 1, after), index(i, after)] for i, j, after in cells]


def projective_plane() -> Mesh:
    """Opposite points of an icosphere made one, at (yz, zx, xy): Steiner's Roman surface.

    The sphere is turned a little first, so that no vertices come to lie on the triple point or the double lines.
    """
    vertices, faces = icosphere(2)
    x, y, z = _turn(0.3, 0.5) @ vertices.T
    opposite = np.argmin(np.linalg.norm(vertices[:, None] + vertices, axis=2), axis=1)
    index = np.arange(len(vertices))
    kept, number = np.unique(np.minimum(index, opposite), return_inverse=True)
    halves = {tuple(sorted(number[face])): number[face].tolist() for face in reversed(faces)}
    return np.stack([y * z, z * x, x * y], axis=1)[kept], list(halves.values())


def _turn(a: float, b: float) -> Floats:
    about_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    return np.asarray(about_x @ about_z)


def three_crosscaps(parts: int = 6) -> Mesh:
    """A sphere of quads, with a crosscap in place of a disc on the sides +x, +y and +z."""
    polygons: list[Floats] = []
    for side in _free_squares((0, 0, 0), {(0, 0, 0)}):
        small = _split(2 * side - 1, parts)
        if side.mean(axis=0).max() < 1:
            polygons += map(_on_sphere, small)
            continue
        rim = [_on_sphere(p) for p in small if np.sort(np.abs(p.mean(axis=0)))[1] > 1 - 2 / parts]
        polygons += rim + _crosscap(_hole(2 * side - 1, parts))
    return _merged(polygons)


def _on_sphere(points: Floats) -> Floats:
    return np.asarray(points / np.linalg.norm(points, axis=1, keepdims=True))


def _hole(side: Floats, parts: int) -> Floats:
    """The boundary of a side of the cube without its outermost squares, on the sphere and counterclockwise."""
    centre, count = side.mean(axis=0), parts - 2
    corners = centre + (side - centre) * (count / parts)
    share = np.arange(count)[:, None] / count
    edges = [a + share * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    return _on_sphere(np.concatenate(edges))


def _crosscap(ring: Floats) -> list[Floats]:
    """An annulus from a ring to a small circle above it that is run through twice: opposite points of it are one."""
    n, centre = len(ring), ring.mean(axis=0)
    up = centre / np.linalg.norm(centre)
    right = (ring[0] - centre) / np.linalg.norm(ring[0] - centre)
    angle = 2 * TAU * np.arange(n)[:, None] / n
    inner = centre + 0.6 * up + 0.15 * (np.cos(angle) * right + np.sin(angle) * np.cross(up, right))
    rings = [ring, ring + 0.5 * (inner - ring) + 0.2 * up, inner]
    return [np.array([a[i], a[(i + 1) % n], b[(i + 1) % n], b[i]]) for a, b in pairwise(rings) for i in range(n)]


ENTRIES = {
    "sphere": Entry("sphere", True, 0, lambda: icosphere(2)),
    "cube": Entry("sphere", True, 0, cube),
    "dodecahedron": Entry("sphere", True, 0, dodecahedron),
    "projective_plane": Entry("projective plane", False, 1, projective_plane),
    "torus": Entry("torus", True, 1, lambda: torus(24, 12)),
    "klein_bottle": Entry("Klein bottle", False, 2, lambda: klein_bottle(24, 12)),
    "plate_genus2_coarse": Entry("sphere with 2 handles", True, 2, lambda: plate(5, 3, [(1, 1), (3, 1)])),
    "plate_genus2": Entry("sphere with 2 handles", True, 2, lambda: plate(5, 3, [(1, 1), (3, 1)], parts=2)),
    "plate_genus3": Entry("sphere with 3 handles", True, 3, lambda: plate(7, 3, [(1, 1), (3, 1), (5, 1)])),
    "plate_genus5": Entry("sphere with 5 handles", True, 5, lambda: plate(11, 3, [(x, 1) for x in range(1, 11, 2)])),
    "three_crosscaps": Entry("sphere with 3 crosscaps", False, 3, three_crosscaps),
}


def off_text(mesh: Mesh) -> str:
    """A mesh as an OFF file."""
    vertices, faces = mesh
    lines = ["OFF", f"{len(vertices)} {len(faces)} {edge_count(faces)}"]
    # Adding 0 turns -0 into 0.
    lines += [" ".join(f"{c:.9g}" for c in np.round(point, 9) + 0.0) for point in vertices]
    lines += [" ".join(map(str, [len(face), *face])) for face in faces]
    return "\n".join(lines) + "\n"


def edge_count(faces: Faces) -> int:
    """The number of pairs of vertices that follow one another in some face."""
    return len({frozenset((a, b)) for face in faces for a, b in zip(face, face[1:] + face[:1], strict=True)})


def index_text(meshes: dict[str, Mesh]) -> str:
    """The index of all meshes as TOML, one table for each file."""
    return "\n".join(_table(name, *meshes[name]) for name in ENTRIES)


def _table(name: str, vertices: Floats, faces: Faces) -> str:
    entry = ENTRIES[name]
    values = {
        "vertices": len(vertices),
        "edges": edge_count(faces),
        "faces": len(faces),
        "surface": f'"{entry.surface}"',
        "orientable": str(entry.orientable).lower(),
        "genus" if entry.orientable else "crosscaps": entry.genus,
        "source": '"generated by make.py"',
        "licence": '"CC0-1.0"',
    }
    return f'["{name}.off"]\n' + "".join(f"{key} = {value}\n" for key, value in values.items())


def main(folder: Path) -> None:
    """Write every mesh and the index into a folder."""
    meshes = {name: entry.make() for name, entry in ENTRIES.items()}
    for name, mesh in meshes.items():
        (folder / f"{name}.off").write_text(off_text(mesh), encoding="ascii", newline="\n")
    (folder / "index.toml").write_text(index_text(meshes), encoding="ascii", newline="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
