"""Random polyhedra of a known surface: reference polyhedra changed by steps that keep the surface."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from hypothesis import strategies as st

from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.testing.polyhedra import reference_polyhedra

NAMES = sorted(reference_polyhedra())


def face_lists(mesh: Polyhedron) -> list[list[int]]:
    return [mesh.face_corners(face).tolist() for face in range(mesh.face_count)]


def edges_of(faces: list[list[int]]) -> set[tuple[int, int]]:
    return {(min(e), max(e)) for face in faces for e in zip(face, face[1:] + face[:1], strict=True)}


def with_split_edge(faces: list[list[int]], fresh: int, rng: np.random.Generator) -> tuple[list[list[int]], list[int]]:
    """A new vertex on a random edge; returns the faces and the vertices that it lies between."""
    ends = sorted(edges_of(faces))[rng.integers(len(edges_of(faces)))]
    changed = []
    for face in faces:
        longer = []
        for i, j in zip(face, face[1:] + face[:1], strict=True):
            longer += [i, fresh] if {i, j} == set(ends) else [i]
        changed.append(longer)
    return changed, list(ends)


def with_starred_face(
    faces: list[list[int]], fresh: int, rng: np.random.Generator
) -> tuple[list[list[int]], list[int]]:
    """A new vertex in a random face, joined to all its corners."""
    chosen = int(rng.integers(len(faces)))
    face = faces[chosen]
    star = [[i, j, fresh] for i, j in zip(face, face[1:] + face[:1], strict=True)]
    return faces[:chosen] + star + faces[chosen + 1 :], face


def with_diagonal(faces: list[list[int]], rng: np.random.Generator) -> list[list[int]]:
    """A random face cut in two, unless its only diagonals have the ends of an edge that exists."""
    chosen, known = int(rng.integers(len(faces))), edges_of(faces)
    face = faces[chosen]
    apart = [(a, b) for a, b in combinations(range(len(face)), 2) if 1 < b - a < len(face) - 1]
    free = [(a, b) for a, b in apart if tuple(sorted((face[a], face[b]))) not in known]
    if not free:
        return faces
    a, b = free[rng.integers(len(free))]
    return [*faces[:chosen], face[a : b + 1], face[b:] + face[: a + 1], *faces[chosen + 1 :]]


def grown(name: str, seed: int, steps: int) -> Polyhedron:
    """A reference polyhedron with random split edges, starred faces and diagonals; new vertices near random places."""
    rng = np.random.default_rng(seed)
    start = reference_polyhedra()[name]
    vertices, faces = start.vertices.tolist(), face_lists(start)
    for _ in range(steps):
        kind = rng.integers(3)
        if kind == 2:
            faces = with_diagonal(faces, rng)
            continue
        faces, around = (with_split_edge, with_starred_face)[kind](faces, len(vertices), rng)
        share = rng.dirichlet(np.full(len(around), 4.0))
        vertices.append((share @ np.array(vertices)[around] + rng.normal(scale=0.01, size=3)).tolist())
    return Polyhedron.from_faces(vertices, faces)


def relabelled(mesh: Polyhedron, rng: np.random.Generator) -> Polyhedron:
    """The same polyhedron with vertices and faces in another order, and faces from other first corners."""
    number = rng.permutation(len(mesh.vertices))
    faces = [np.roll(number[face], rng.integers(len(face))).tolist() for face in face_lists(mesh)]
    vertices = np.empty_like(mesh.vertices)
    vertices[number] = mesh.vertices
    return Polyhedron.from_faces(vertices, [faces[i] for i in rng.permutation(len(faces))])


def random_polyhedra(most_steps: int = 12) -> st.SearchStrategy[Polyhedron]:
    return st.builds(grown, st.sampled_from(NAMES), st.integers(0, 2**32 - 1), st.integers(0, most_steps))


def random_triangle_meshes(most_steps: int = 12) -> st.SearchStrategy[Polyhedron]:
    return random_polyhedra(most_steps).map(triangulated)


def bent(name: str, seed: int, steps: int) -> Polyhedron:
    """A reference polyhedron with vertices of valence 2 that are far off their edges, and some diagonals."""
    rng = np.random.default_rng(seed)
    start = reference_polyhedra()[name]
    vertices, faces = start.vertices.tolist(), face_lists(start)
    for _ in range(steps):
        faces, ends = with_split_edge(faces, len(vertices), rng)
        middle = rng.dirichlet([4.0, 4.0]) @ np.array(vertices)[ends]
        vertices.append((middle + rng.normal(scale=0.3, size=3)).tolist())
        faces = with_diagonal(faces, rng) if rng.random() < 0.3 else faces
    return Polyhedron.from_faces(vertices, faces)


def with_pocket(mesh: Polyhedron, halfedge: int) -> Polyhedron:
    """An edge doubled, and two triangles between the two edges, glued along their other sides: valence 2."""
    a, b, twin = int(mesh.tail[halfedge]), int(mesh.head[halfedge]), int(mesh.twin[halfedge])
    v, first = len(mesh.vertices), len(mesh.tail)
    glued = np.concatenate([mesh.twin, [halfedge, first + 5, first + 4, twin, first + 2, first + 1]])
    glued[[halfedge, twin]] = first, first + 3
    same = np.concatenate([mesh.same, [False, False, False, mesh.same[halfedge], False, False]])
    same[halfedge] = False
    return Polyhedron(
        np.concatenate([mesh.vertices, [(mesh.vertices[a] + mesh.vertices[b]) / 2 + 0.1]]),
        np.concatenate([mesh.offsets, [first + 3, first + 6]]),
        np.concatenate([mesh.tail, [b, a, v, a, b, v]]),
        glued,
        same,
    )


def bent_polyhedra(most_steps: int = 12) -> st.SearchStrategy[Polyhedron]:
    return st.builds(bent, st.sampled_from(NAMES), st.integers(0, 2**32 - 1), st.integers(0, most_steps))


def polyhedra_with_doubled_edges() -> st.SearchStrategy[Polyhedron]:
    edges = st.lists(st.integers(0, 2**32 - 1), min_size=1, max_size=4)

    def grown_pockets(mesh: Polyhedron, places: list[int]) -> Polyhedron:
        for place in places:
            mesh = with_pocket(mesh, place % len(mesh.tail))
        return mesh

    return st.builds(grown_pockets, bent_polyhedra(4), edges)
