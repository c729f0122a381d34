"""Crease sites: where a domain of splines with creases has its vertices, on creases and between them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orbiframe.meshes.edge_paths import Graph, dijkstra_forest, edge_graph, farthest_points
from orbiframe.meshes.sizes import vector_areas
from orbiframe.triangulations.crease_chains import CreaseGraph
from orbiframe.triangulations.local_girth import site_density
from orbiframe.triangulations.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# No site between creases is nearer to one than this share of the spacing.
_APART = 0.6
# How fast the spacing grows away from creases with a smaller one.
_SLOPE = 0.7
# The spacing is found by so many trials, or as soon as the number of functions is as near as this.
_TRIALS, _ENOUGH = 5, 0.08
# Between two sites a crease turns by no more than about this.
_BEND = np.radians(45)
# What the surface turns by from site to site, if there are as many functions as asked for without its curvature.
_ARC = np.radians(60)


class Asked(NamedTuple):
    """What sites are for: about `size` functions, of which so many belong to a vertex, an edge and a triangle; a vertex
    on a crease has two more, and one more edge of the crease and two hairs are open.

    curvature: (V,), one over the radius of curvature at the vertices of the mesh; most: up to so many functions are
    made if curvature and creases ask for more than size; grading: how much the density follows the girth; more:
    unknowns of a vertex on a crease, and open edges there, besides.
    """

    size: int
    unknowns: tuple[int, int, int]
    curvature: Floats | None = None
    most: int = 0
    grading: float = 0.6
    more: tuple[int, int] = (2, 3)


def crease_sites(triangulation: Triangulation, asked: Asked) -> Ints:
    """Sites on the creases of a map, then between them, about as many as the functions ask for."""
    at_vertex, on_edge, in_face = asked.unknowns
    each, more = at_vertex + 3 * on_edge + 2 * in_face, asked.more[0] + asked.more[1] * on_edge
    mesh, density = triangulation.polyhedron, site_density(triangulation, asked.grading)
    area = np.linalg.norm(vector_areas(mesh), axis=1) @ (density[mesh.triangles].mean(axis=1) ** 2)
    spacing = float(np.sqrt(each * area / asked.size))
    if asked.curvature is not None:
        density = np.maximum(density, asked.curvature * spacing / _ARC)
    spread = _Spread(triangulation, mesh.edge_lengths * (density[mesh.tail] + density[mesh.head]) / 2)
    goal = asked.size
    for trial in range(_TRIALS):
        on, between = spread.sites(spacing)
        found = (each + more) * len(on) + each * len(between)
        goal = goal if trial else max(goal, min(found, asked.most))
        if abs(found / goal - 1) < _ENOUGH:
            break
        spacing *= float(np.clip(np.sqrt(found / goal), 0.5, 2.0))
    return np.unique(np.concatenate([on, between]))


class _Spread(NamedTuple):
    """A map with creases, and the lengths of its halfedges by the density of sites, (H,)."""

    triangulation: Triangulation
    length: Floats

    def sites(self, spacing: float) -> tuple[Ints, Ints]:
        """Sites on and between creases at this spacing, between them the nearer, the nearer those on creases are."""
        mesh, length = self.triangulation.polyhedron, self.length
        graph, rim = edge_graph(mesh, length), np.unique(mesh.tail[self.triangulation.crease])
        on, apart = self._on_creases(spacing)
        reach = dijkstra_forest(_with_hub(graph, on, apart / _SLOPE), np.array([len(mesh.vertices)])).distance[:-1]
        local = np.minimum(spacing, _SLOPE * reach)
        scaled = edge_graph(mesh, length * (spacing / local[mesh.tail] + spacing / local[mesh.head]) / 2)
        hub = _with_hub(scaled, rim, np.full(len(rim), (1 - _APART) * spacing))
        chosen = farthest_points(hub, len(mesh.vertices), first=len(mesh.vertices), radius=spacing).chosen[1:]
        return on, chosen

    def _on_creases(self, spacing: float) -> tuple[Ints, Floats]:
        """The corners and ends of creases, and vertices between them at about this spacing, and how far apart they are.

        Nearer together on short curves and where a curve turns.
        """
        flat, mesh = self.triangulation, self.triangulation.polyhedron
        assert flat.crease is not None
        apart, scale = np.full(len(mesh.vertices), np.inf), _scales(mesh.edge_lengths, self.length, mesh.tail)
        for chain in CreaseGraph.of(mesh, flat.crease, seam=flat.seam).chains(flat):
            way = np.linalg.norm(np.diff(mesh.vertices[chain.vertices], axis=0), axis=1)
            reached = np.concatenate([[0.0], np.cumsum(way * scale[chain.vertices[:-1]])])
            least = 3 if chain.vertices[0] == chain.vertices[-1] else 1
            count = max(least, round(reached[-1] / spacing), math.ceil(_turning(mesh.vertices[chain.vertices]) / _BEND))
            wanted = np.arange(count + 1) * reached[-1] / count
            site = chain.vertices[np.unique(np.abs(reached[:, None] - wanted).argmin(axis=0))]
            apart[site] = np.minimum(apart[site], reached[-1] / count)
        on = np.flatnonzero(np.isfinite(apart))
        return on, np.minimum(apart[on], spacing)


def _turning(x: Floats) -> float:
    """The sum of the angles by which a curve (n, 3) turns at its inner vertices."""
    way = np.diff(x, axis=0)
    way /= np.maximum(np.linalg.norm(way, axis=1), np.finfo(float).tiny)[:, None]
    turn = 2 * np.arcsin(np.minimum(np.linalg.norm(np.diff(way, axis=0), axis=1) / 2, 1.0))
    return float(turn.sum())


def _scales(edges: Floats, length: Floats, tail: Ints) -> Floats:
    """The length of sites per length in space at the vertices."""
    weight = np.bincount(tail, weights=edges)
    return np.bincount(tail, weights=length) / np.maximum(weight, np.finfo(float).tiny)


def _with_hub(graph: Graph, rim: Ints, length: Floats) -> Graph:
    """The graph with one more vertex, joined to all of a rim by links of some lengths."""
    count, degree = len(graph.start) - 1, np.diff(graph.start)
    owner = np.concatenate([np.repeat(np.arange(count), degree), rim, np.full(len(rim), count)])
    neighbour = np.concatenate([graph.neighbour, np.full(len(rim), count), rim])
    lengths = np.concatenate([graph.length, length, length])
    order = np.argsort(owner, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=count + 1))]).astype(np.intp)
    none = np.zeros(len(owner), dtype=np.intp)
    return Graph(start, neighbour[order], lengths[order], none, none.astype(np.bool_))
