"""The laws of a marker: what makes a marking an isomorphism of fundamental groups."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from orbiframe.components.geometry_names import geometry_name
from orbiframe.components.registry import Registry
from orbiframe.groups.corner_elements import corner_elements
from orbiframe.groups.fundamental_polygon import regular_polygon
from orbiframe.groups.marking import Marking
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.surface_type import surface_type
from orbiframe.planes.geometry import Geometry
from orbiframe.planes.precise_isometry import PreciseIsometry
from orbiframe.testing.lab import Lab
from orbiframe.words.word import Word

Component = Callable[[Polyhedron], Marking]
Ints = NDArray[np.intp]

_TOLERANCE = 1e-9


def word_is_that_of_the_surface(component: Component, lab: Lab) -> None:
    """The word is that of the surface of the polyhedron, and has one vertex unless that is a sphere."""
    for name, mesh in lab.polyhedra.items():
        word, surface = component(mesh).word, surface_type(mesh)
        assert word.euler_characteristic == surface.euler_characteristic, f"{name}: '{word}' is a {word.surface}"
        assert word.orientable == surface.orientable, f"{name}: '{word}' is a {word.surface}"
        vertices = 2 if surface.euler_characteristic == 2 else 1
        assert len(word.vertex_cycles) == vertices, f"{name}: '{word}' has {len(word.vertex_cycles)} vertices"


def transitions_form_a_cocycle(component: Component, lab: Lab) -> None:
    """In a faithful representation halfedges and twins carry inverse elements, and those round a face cancel."""
    for name, marking in _markings(component, lab):
        mesh, elements = marking.polyhedron, _elements(marking)
        corner = elements[marking.position]
        step = corner.inverse @ corner[mesh.next]
        back = np.where(mesh.same, np.arange(len(mesh.tail)), mesh.next)
        ahead = np.where(mesh.same, mesh.next, np.arange(len(mesh.tail)))
        twin = corner[back[mesh.twin]].inverse @ corner[ahead[mesh.twin]]
        worst = _distance(step, twin).max()
        assert worst < _TOLERANCE, f"{name}: a halfedge and its twin carry elements at the distance {worst:.2g}"
        for face in range(mesh.face_count):
            product = _product(step, mesh.offsets[face], mesh.offsets[face + 1])
            assert product < _TOLERANCE, f"{name}: the elements round face {face} move the origin by {product:.2g}"


def letters_generate(component: Component, lab: Lab) -> None:
    """Each letter is what its side carries, and edges that carry nothing join all vertices: loops give every letter."""
    for name, marking in _markings(component, lab):
        mesh, (start, end) = marking.polyhedron, marking.transitions
        letters = sorted({abs(letter) for letter in marking.word.letters})
        carried = [marking.subword(int(side)) for side in marking.sides]
        assert sorted(abs(word[0]) for word in carried if len(word) == 1) == letters, (
            f"{name}: the sides carry {carried}"
        )
        still = np.flatnonzero(start == end)
        size = len(mesh.vertices)
        graph = coo_array((np.ones(len(still)), (mesh.tail[still], mesh.head[still])), shape=(size, size)).tocsr()
        parts = connected_components(graph, directed=False)[0]
        assert parts == 1, f"{name}: edges that carry the identity leave the vertices in {parts} parts"


def loops_run_along_edges(component: Component, lab: Lab) -> None:
    """There is a closed path of edges for every letter, all from one base point, and they span the homology mod 2."""
    for name, marking in _markings(component, lab):
        mesh = marking.polyhedron
        ends = {(int(i), int(j)) for i, j in zip(mesh.tail, mesh.head, strict=True)}
        assert len(marking.loops) == len(marking.sides) == len(marking.word) // 2, f"{name}: {len(marking.loops)} loops"
        assert len({int(loop[0]) for loop in marking.loops}) == 1, f"{name}: loops with several base points"
        for loop in marking.loops:
            steps = {(int(i), int(j)) for i, j in pairwise(loop)}
            assert loop[0] == loop[-1], f"{name}: a loop that does not close"
            assert all((i, j) in ends or (j, i) in ends for i, j in steps), f"{name}: a loop that leaves the edges"
        assert _rank_beside_faces(marking) == len(marking.loops), f"{name}: loops that depend on one another"


def order_of_faces_does_not_matter(component: Component, lab: Lab) -> None:
    """On edges of general lengths the loops and the word are the same however faces and corners are numbered."""
    for name, polyhedron in lab.polyhedra.items():
        noise = lab.rng.normal(scale=0.01 * polyhedron.diagonal, size=polyhedron.vertices.shape)
        mesh = polyhedron.with_vertices(polyhedron.vertices + noise)
        here = component(mesh)
        there = component(_reordered(mesh, lab.rng))
        assert _plain(here.word) == _plain(there.word), f"{name}: the words are '{here.word}' and '{there.word}'"
        lengths = here.loop_length, there.loop_length
        assert np.isclose(*lengths, rtol=1e-9), f"{name}: the loops have the lengths {lengths[0]:.6g}, {lengths[1]:.6g}"


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    word_is_that_of_the_surface,
    transitions_form_a_cocycle,
    letters_generate,
    loops_run_along_edges,
    order_of_faces_does_not_matter,
)


def _markings(component: Component, lab: Lab) -> Iterator[tuple[str, Marking]]:
    """The markings of the reference polyhedra that are no spheres."""
    for name, mesh in lab.polyhedra.items():
        if surface_type(mesh).euler_characteristic < 2:
            yield name, component(mesh)


def _elements(marking: Marking) -> PreciseIsometry:
    """For every corner of the polygon the element that takes corner 0 to it, in a group that is faithful.

    On the projective plane the antipodal map, written as the reflection, which has order 2 as well.
    """
    word = marking.word
    if len(word) == 2:
        return PreciseIsometry.rotation(1, np.zeros(2), np.array([False, True]))
    return corner_elements(regular_polygon(_geometry(geometry_name(word.euler_characteristic)), word))


@cache
def _geometry(name: str) -> Geometry:
    made: Geometry = Registry.discover(only=["geometries"]).load("geometry", name)()
    return made


def _distance(first: PreciseIsometry, second: PreciseIsometry) -> NDArray[np.float64]:
    """How far first^-1 second is from the identity."""
    return np.asarray(np.abs((first.inverse @ second).matrix - np.eye(3)).max(axis=(1, 2)))


def _product(step: PreciseIsometry, start: int, end: int) -> float:
    product = step[np.array([start])]
    for halfedge in range(start + 1, end):
        product = product @ step[np.array([halfedge])]
    return float(np.abs(product.matrix - np.eye(3)).max())


def _rank_beside_faces(marking: Marking) -> int:
    """The rank over the integers mod 2 of the loops as chains of edges, modulo boundaries of faces."""
    mesh = marking.polyhedron
    edge = {}
    for h in range(len(mesh.tail)):
        edge[int(mesh.tail[h]), int(mesh.head[h])] = edge[int(mesh.head[h]), int(mesh.tail[h])] = int(mesh.edge[h])
    faces = [mesh.edge[mesh.offsets[f] : mesh.offsets[f + 1]].tolist() for f in range(mesh.face_count)]
    loops = [[edge[int(i), int(j)] for i, j in pairwise(loop)] for loop in marking.loops]
    return _rank(faces + loops) - _rank(faces)


def _rank(chains: list[list[int]]) -> int:
    """The rank of chains of edges mod 2, each an integer whose bits are the edges that occur an odd number of times."""
    leading: dict[int, int] = {}
    for chain in chains:
        bits = 0
        for edge in chain:
            bits ^= 1 << edge
        while bits and bits.bit_length() in leading:
            bits ^= leading[bits.bit_length()]
        if bits:
            leading[bits.bit_length()] = bits
    return len(leading)


def _plain(word: Word) -> tuple[int, ...]:
    """The least of all ways to write a cyclic word: from any letter on, in both senses, letters named as they come."""
    turns = [w[k:] + w[:k] for w in (word.letters, word.inverse.letters) for k in range(len(word))]
    return min(_numbered(turn) for turn in turns)


def _numbered(letters: tuple[int, ...]) -> tuple[int, ...]:
    names: dict[int, int] = {}
    for letter in letters:
        names.setdefault(abs(letter), (len(names) // 2 + 1) * int(np.sign(letter)))
        names.setdefault(-abs(letter), -names[abs(letter)])
    return tuple(names[letter] for letter in letters)


def _reordered(mesh: Polyhedron, rng: np.random.Generator) -> Polyhedron:
    """The mesh with faces in another order, each from another first corner, and vertices numbered anew."""
    number = rng.permutation(len(mesh.vertices))
    faces = [np.roll(number[mesh.face_corners(f)], rng.integers(9)) for f in rng.permutation(mesh.face_count)]
    vertices = np.empty_like(mesh.vertices)
    vertices[number] = mesh.vertices
    return Polyhedron.from_faces(vertices, [face.tolist() for face in faces])


# ---- mutants: each breaks the law of its name -----------------------------------------------------------------------


def _with(change: Callable[[Marking], Marking]) -> Callable[[Component], Component]:
    return lambda component: lambda polyhedron: change(component(polyhedron))


def _other_word(marking: Marking) -> Marking:
    """One letter turned over: another surface."""
    first, *rest = marking.word.letters
    return replace(marking, word=Word((-first, *rest)))


def _moved_corner(marking: Marking) -> Marking:
    """One corner one side further."""
    position = marking.position.copy()
    position[0] = (position[0] + 1) % len(marking.word)
    return replace(marking, position=position)


def _other_sides(marking: Marking) -> Marking:
    """The sides are edges of the tree."""
    start, end = marking.transitions
    return replace(marking, sides=np.resize(np.flatnonzero(start == end), len(marking.sides)))


def _one_loop_twice(marking: Marking) -> Marking:
    """The first loop in place of every other one, and never closed if it is the only one."""
    first = marking.loops[:1]
    return replace(
        marking, loops=tuple(loop[:-1] for loop in first) if len(marking.loops) == 1 else first * len(marking.loops)
    )


def _longer_by_number(marking: Marking) -> Marking:
    """A detour that depends on the number of the first vertex."""
    detours = int(marking.polyhedron.tail[0])
    loops = [np.concatenate([np.tile(loop[:2], detours), loop]) for loop in marking.loops]
    return replace(marking, loops=tuple(loops))


MUTANTS: dict[str, Callable[[Component], Component]] = {
    "word_is_that_of_the_surface": _with(_other_word),
    "transitions_form_a_cocycle": _with(_moved_corner),
    "letters_generate": _with(_other_sides),
    "loops_run_along_edges": _with(_one_loop_twice),
    "order_of_faces_does_not_matter": _with(_longer_by_number),
}
