"""Triangulations whose edges have names of their own: any cell complex of triangles, and random steps among them.

A face is three signed edges, run through backwards where the sign is negative. So two vertices may share several edges,
an edge may be a loop, and a face may meet itself, which lists of vertices cannot say.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from orbiframe.meshes.polyhedron import Polyhedron

# One word for the surface of every kind: a letter is an edge, a capital one runs backwards.
WORDS = {
    "sphere": "aA",
    "projective plane": "aa",
    "torus": "abAB",
    "Klein bottle": "abaB",
    "genus 2": "abABcdCD",
    "genus 3": "abABcdCDefEF",
    "3 crosscaps": "aabbcc",
    "4 crosscaps": "aabbccdd",
}


@dataclass
class SignedFaces:
    """faces: triples of signed edges 1, 2, 3, …; ends: the two vertices of every edge, and how many vertices there are.

    Every edge occurs twice. Vertices may be missing numbers after collapses.
    """

    faces: list[list[int]]
    ends: dict[int, tuple[int, int]]
    fresh: int = field(default=0)

    def tail(self, edge: int) -> int:
        return self.ends[abs(edge)][edge < 0]

    def head(self, edge: int) -> int:
        return self.tail(-edge)

    def new_edge(self, tail: int, head: int) -> int:
        edge = max(self.ends, default=0) + 1
        self.ends[edge] = tail, head
        return edge

    def new_vertex(self) -> int:
        self.fresh += 1
        return self.fresh - 1

    def sides(self, edge: int) -> list[tuple[int, int]]:
        """The two places (face, slot) of an edge."""
        return [(f, s) for f, face in enumerate(self.faces) for s in range(3) if abs(face[s]) == abs(edge)]

    def around(self, edge: int) -> tuple[int, int, list[int], list[int]] | None:
        """The two faces of an edge, turned to (e, x, y) and (-e, z, w); None where they are one face."""
        (f, s), (g, t) = self.sides(edge)
        if f == g:
            return None
        first, second = (_turned(self.faces[face], slot) for face, slot in ((f, s), (g, t)))
        if first[0] == second[0]:
            second = [-second[0], -second[2], -second[1]]
        return f, g, first, second

    def flip(self, edge: int) -> bool:
        """The other diagonal of the two faces beside an edge."""
        found = self.around(edge)
        if found is None:
            return False
        f, g, (e, x, y), (_, z, w) = found
        del self.ends[abs(e)]
        d = self.new_edge(self.head(z), self.head(x))
        self.faces[f], self.faces[g] = [d, y, z], [-d, w, x]
        return True

    def split_face(self, face: int) -> int:
        """A vertex inside a face, joined to its three corners."""
        a, b, c = self.faces[face]
        v = self.new_vertex()
        p, q, r = (self.new_edge(self.tail(side), v) for side in (a, b, c))
        self.faces[face] = [a, q, -p]
        self.faces += [[b, r, -q], [c, p, -r]]
        return v

    def split_edge(self, edge: int) -> int:
        """A vertex on an edge, joined to the opposite corners of its faces."""
        tail, head = self.ends[edge]
        v = self.new_vertex()
        first, second = self.new_edge(tail, v), self.new_edge(v, head)
        for _ in range(2):
            f, s = self.sides(edge)[0]
            e, x, y = _turned(self.faces[f], s)
            one, two = (first, second) if e > 0 else (-second, -first)
            d = self.new_edge(v, self.tail(y))
            self.faces[f] = [one, d, y]
            self.faces.append([two, x, -d])
        del self.ends[edge]
        return v

    def collapse(self, edge: int) -> bool:
        """Both ends of an edge made one and its two faces taken away, where a surface is left."""
        found = self.around(edge)
        if found is None or self.ends[abs(edge)][0] == self.ends[abs(edge)][1]:
            return False
        f, g, (e, x, y), (_, z, w) = found
        if len({abs(side) for side in (x, y, z, w)}) < 4 or len(self.faces) <= 2:
            return False
        kept, gone = self.tail(e), self.head(e)
        self.faces = [face for n, face in enumerate(self.faces) if n not in (f, g)]
        self._rename({abs(x): -y if x > 0 else y, abs(w): -z if w > 0 else z})
        for name in (abs(e), abs(x), abs(w)):
            del self.ends[name]
        self.ends = {k: tuple(kept if v == gone else v for v in pair) for k, pair in self.ends.items()}  # type: ignore[misc]
        return True

    def _rename(self, names: dict[int, int]) -> None:
        def renamed(edge: int) -> int:
            new = names.get(abs(edge), abs(edge))
            return new if edge > 0 else -new

        self.faces = [[renamed(edge) for edge in face] for face in self.faces]

    def step(self, rng: np.random.Generator) -> None:
        """A random flip, split or collapse."""
        edge = int(rng.choice(sorted(self.ends)))
        kind = int(rng.integers(6))
        if kind < 3:
            self.flip(edge)
        elif kind == 3:
            self.split_face(int(rng.integers(len(self.faces))))
        elif kind == 4:
            self.split_edge(edge)
        else:
            self.collapse(edge)

    def polyhedron(self, vertices: np.ndarray | None = None) -> Polyhedron:
        """The complex as a polyhedron; vertices: by default random ones, the same for the same number."""
        tail = np.array([self.tail(edge) for face in self.faces for edge in face])
        used, tail = np.unique(tail, return_inverse=True)
        place: dict[int, list[int]] = {}
        signed = [edge for face in self.faces for edge in face]
        for h, edge in enumerate(signed):
            place.setdefault(abs(edge), []).append(h)
        twin, same = np.empty(len(signed), dtype=np.intp), np.zeros(len(signed), dtype=bool)
        for h, k in place.values():
            twin[h], twin[k] = k, h
            same[[h, k]] = signed[h] == signed[k]
        points = np.random.default_rng(7).normal(size=(len(used), 3)) if vertices is None else vertices
        return Polyhedron(points, 3 * np.arange(len(self.faces) + 1), tail, twin, same)


def _turned(face: list[int], slot: int) -> list[int]:
    return face[slot:] + face[:slot]


def cone(word: str) -> SignedFaces:
    """The polygon of a word, its sides glued, with a vertex in the middle that is joined to all corners."""
    sides = _letters(word)
    result, corner = _corners(sides)
    centre = result.new_vertex()
    spokes = [result.new_edge(corner[i], centre) for i in range(len(sides))]
    result.faces = [[side, spokes[(i + 1) % len(sides)], -spokes[i]] for i, side in enumerate(sides)]
    return result


def fan(word: str) -> SignedFaces:
    """The polygon of a word with four letters or more, its sides glued, cut by all diagonals from its first corner."""
    sides = _letters(word)
    result, corner = _corners(sides)
    last = sides[0]
    for i, side in enumerate(sides[1:-2], start=1):
        diagonal = result.new_edge(corner[0], corner[i + 1])
        result.faces.append([last, side, -diagonal])
        last = diagonal
    result.faces.append([last, *sides[-2:]])
    return result


def _letters(word: str) -> list[int]:
    number = {letter: n + 1 for n, letter in enumerate(sorted(set(word.lower())))}
    return [number[c] if c.islower() else -number[c.lower()] for c in word]


def _corners(sides: list[int]) -> tuple[SignedFaces, list[int]]:
    """The vertices and edges of a glued polygon, and the vertex of every corner; corner i is the tail of side i."""
    n = len(sides)
    parent = list(range(n))

    def root(i: int) -> int:
        while parent[i] != i:
            i = parent[i]
        return i

    for i in range(n):
        for j in range(i):
            if abs(sides[i]) == abs(sides[j]):
                same = sides[i] == sides[j]
                parent[root(i)] = root(j if same else (j + 1) % n)
                parent[root((i + 1) % n)] = root((j + 1) % n if same else j)
    roots = sorted({root(i) for i in range(n)})
    corner = [roots.index(root(i)) for i in range(n)]
    ends = {}
    for i, side in enumerate(sides):
        pair = corner[i], corner[(i + 1) % n]
        ends[abs(side)] = pair if side > 0 else pair[::-1]
    return SignedFaces([], ends, len(roots)), corner


def wandering(word: str, seed: int, steps: int) -> SignedFaces:
    """The cone of a word after so many random steps."""
    rng = np.random.default_rng(seed)
    result = cone(word)
    for _ in range(steps):
        result.step(rng)
    return result
