"""Triangle meshes whose maps are known or whose surface is known: symmetric, glued, random ones, and the datasets."""

from __future__ import annotations

from functools import cache, reduce
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from orbiframe.components.registry import Registry
from orbiframe.files.gate import read
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.orientation import oriented
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.subdivision import refine
from orbiframe.testing.polyhedra import reference_polyhedra

DATASETS = Path(__file__).parents[1] / "datasets"
REGISTRY = Registry.discover()

# Surfaces of every type, as connected sums of T (torus, 7 vertices) and P (projective plane, 6 vertices).
SUMS = ("T", "TT", "TTT", "PP", "PPP", "PPPP", "PT")


def geometry(curvature: int):
    return REGISTRY.load("geometry", {1: "s2", 0: "e2", -1: "h2"}[curvature])()


@cache
def dataset(name: str, density: int = 1) -> Polyhedron:
    mesh = oriented(triangulated(read(DATASETS / f"{name}.off", REGISTRY)))
    return refine(mesh, density).polyhedron


def reference(name: str, density: int = 1) -> Polyhedron:
    return refine(triangulated(reference_polyhedra()[name]), density).polyhedron


def hull(points: np.ndarray) -> Polyhedron:
    """The convex hull of points about the origin, faces counterclockwise from outside."""
    faces = ConvexHull(points).simplices
    inward = np.linalg.det(points[faces]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Polyhedron.from_faces(points, faces)


def platonic(name: str) -> Polyhedron:
    """The tetrahedron, octahedron or icosahedron with vertices on the unit sphere."""
    golden = (1 + np.sqrt(5)) / 2
    rectangle = np.array([[0, a, b * golden] for a in (1, -1) for b in (1, -1)])
    points = {
        "tetrahedron": np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float),
        "octahedron": np.concatenate([np.eye(3), -np.eye(3)]),
        "icosahedron": np.concatenate([np.roll(rectangle, k, axis=1) for k in range(3)]),
    }[name]
    return hull(points / np.linalg.norm(points, axis=1, keepdims=True))


def icosphere(density: int) -> Polyhedron:
    """The icosahedron refined, its vertices pushed to the unit sphere."""
    mesh = refine(platonic("icosahedron"), density).polyhedron
    return mesh.with_vertices(mesh.vertices / np.linalg.norm(mesh.vertices, axis=1, keepdims=True))


def klein_quartic() -> Polyhedron:
    """Klein's map {3, 7} of genus 3, 24 vertices, 56 triangles; the vertices lie anywhere.

    Its 168 halfedges are the elements of PSL(2, 7): `next` multiplies by an element of order 3 from the right, `twin`
    by one of order 2, and their product has order 7.
    """

    def canonical(matrix: np.ndarray) -> tuple[int, ...]:
        return min(tuple(int(x) for x in (sign * matrix % 7).ravel()) for sign in (1, -1))

    order_2, order_3 = np.array([[0, -1], [1, 0]]), np.array([[0, -1], [1, 1]])
    rows = np.array(np.meshgrid(*[range(7)] * 4, indexing="ij")).reshape(4, -1).T.reshape(-1, 2, 2)
    group = sorted({canonical(g) for g in rows if (g[0, 0] * g[1, 1] - g[0, 1] * g[1, 0]) % 7 == 1})

    def times(g: tuple[int, ...], h: np.ndarray) -> tuple[int, ...]:
        return canonical(np.array(g).reshape(2, 2) @ h)

    def orbit(g: tuple[int, ...], h: np.ndarray) -> tuple[tuple[int, ...], ...]:
        found = [g]
        while (following := times(found[-1], h)) != g:
            found.append(following)
        return tuple(found)

    vertices = sorted({min(orbit(g, order_2 @ order_3)) for g in group})
    triangles = sorted({min(orbit(g, order_3)) for g in group})
    number = {v: i for i, v in enumerate(vertices)}
    faces = [[number[min(orbit(g, order_2 @ order_3))] for g in orbit(t, order_3)] for t in triangles]
    return Polyhedron.from_faces(np.random.default_rng(0).normal(size=(len(vertices), 3)), faces)


def grid(along: int, across: int, *, twisted: bool = False) -> Polyhedron:
    """A rectangle of along by across squares, each cut in two, glued to a torus or (twisted) to a Klein bottle.

    Triangles 2 q and 2 q + 1 are the halves of square q; halfedge 0 of the first runs along, halfedge 0 of the second
    is the diagonal. Vertex i across + j stands at (i, j). In space it is a torus of revolution, self-touching if
    twisted.
    """
    i, j = np.meshgrid(np.arange(along), np.arange(across), indexing="ij")
    turn = [2 * np.pi * i.ravel() / along, 2 * np.pi * j.ravel() / across]
    return Polyhedron.from_faces(revolved(2.0, 1.0, *turn), grid_faces(along, across, twisted))


def grid_faces(along: int, across: int, twisted: bool = False) -> np.ndarray:
    def corner(i: int, j: int) -> int:
        j = -j if twisted and i == along else j
        return (i % along) * across + j % across

    faces = []
    for i, j in ((i, j) for i in range(along) for j in range(across)):
        a, b, c, d = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
        faces += [[a, b, c], [a, c, d]]
    return np.array(faces)


def revolved(big: float, small: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Points of a torus of revolution, (n, 3)."""
    ring = big + small * np.cos(v)
    return np.stack([ring * np.cos(u), ring * np.sin(u), small * np.sin(v)], axis=1)


@cache
def connected_sum(parts: str) -> Polyhedron:
    """A small surface: "TTP" is two tori and a projective plane, joined along triangles; vertices anywhere."""
    pieces = {"T": reference_polyhedra()["torus"], "P": reference_polyhedra()["projective plane"]}
    faces = reduce(_joined, ([list(face) for face in pieces[part].triangles.tolist()] for part in parts))
    count = max(max(face) for face in faces) + 1
    return oriented(Polyhedron.from_faces(np.random.default_rng(1).normal(size=(count, 3)), faces))


def _joined(first: list[list[int]], second: list[list[int]]) -> list[list[int]]:
    """The last face of the first and the first face of the second taken away, and their corners identified."""
    count = max(max(face) for face in first) + 1
    names = dict(zip(second[0], reversed(first[-1]), strict=True))
    others = sorted({corner for face in second for corner in face} - set(second[0]))
    names |= {corner: count + k for k, corner in enumerate(others)}
    return first[:-1] + [[names[corner] for corner in face] for face in second[1:]]


def shuffled(mesh: Polyhedron, moves: int, rng: np.random.Generator) -> Polyhedron:
    """The same surface after random flips, edge splits and face splits that keep it a simplicial complex."""
    faces, vertices = mesh.triangles.tolist(), mesh.vertices.tolist()
    for _ in range(moves):
        face = faces[rng.integers(len(faces))]
        turn = int(rng.integers(3))
        a, b, c = face[turn:] + face[:turn]
        other = next(f for f in faces if a in f and b in f and f is not face)
        d = next(corner for corner in other if corner not in (a, b))
        kind = rng.choice(["flip", "edge", "face"])
        if kind == "flip":
            if _valence(faces, a) > 3 and _valence(faces, b) > 3 and not any(c in f and d in f for f in faces):
                faces.remove(face), faces.remove(other)
                faces += [[a, d, c], [d, b, c]]
            continue
        fresh = len(vertices)
        ends = [a, b] if kind == "edge" else [a, b, c]
        vertices.append((np.mean([vertices[i] for i in ends], axis=0) + rng.normal(scale=0.01, size=3)).tolist())
        for old in [face, other] if kind == "edge" else [face]:
            faces.remove(old)
            faces += [[fresh if i == out else i for i in old] for out in ends]
    return oriented(Polyhedron.from_faces(vertices, faces))


def _valence(faces: list[list[int]], vertex: int) -> int:
    return sum(vertex in face for face in faces)


def split_face(mesh: Polyhedron, face: int) -> Polyhedron:
    """A vertex in the middle of one face, joined to its corners; it is the last vertex."""
    a, b, c = mesh.triangles[face].tolist()
    fresh = len(mesh.vertices)
    rest = np.delete(mesh.triangles, face, axis=0)
    vertices = np.vstack([mesh.vertices, mesh.vertices[[a, b, c]].mean(axis=0)])
    return Polyhedron.from_faces(vertices, np.vstack([rest, [[a, b, fresh], [b, c, fresh], [c, a, fresh]]]))


def reordered(mesh: Polyhedron, rng: np.random.Generator) -> tuple[Polyhedron, np.ndarray]:
    """Vertices and faces in another order, and the new number (V,) of every vertex."""
    number = rng.permutation(len(mesh.vertices))
    faces = number[mesh.triangles][rng.permutation(mesh.face_count)]
    faces = np.take_along_axis(faces, (np.arange(3) + rng.integers(3, size=(len(faces), 1))) % 3, axis=1)
    vertices = np.empty_like(mesh.vertices)
    vertices[number] = mesh.vertices
    return Polyhedron.from_faces(vertices, faces), number


def lifted_edges(triangulation) -> tuple[np.ndarray, np.ndarray]:
    """Both ends (H, 3) of every halfedge in the frame of the patch of its tail."""
    mesh, atlas = triangulation.polyhedron, triangulation.orbifold.atlas
    far = atlas.geometry.act(atlas.isometry[triangulation.transition], triangulation.points[mesh.head])
    return triangulation.points[mesh.tail], far


def edge_lengths(triangulation) -> np.ndarray:
    """The length in X of every lifted halfedge, (H,)."""
    return triangulation.orbifold.geometry.distance(*lifted_edges(triangulation))
