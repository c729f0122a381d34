"""Small orbifolds in closed form, and the same ones in other patches and frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
from orbiframe_geometries.e2 import E2
from orbiframe_geometries.h2 import H2
from orbiframe_geometries.s2 import S2
from scipy.spatial import cKDTree

from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.orbifolds.atlas import Atlas, Points
from orbiframe.orbifolds.orbifold import Orbifold
from orbiframe.planes.geometry import Geometry
from orbiframe.triangulations.triangulation import Triangulation

OCTAGON_RADIUS = float(np.arccosh(1 / np.tan(np.pi / 8) ** 2))
OCTAGON_STEP = 2 * float(np.arccosh(1 / np.tan(np.pi / 8)))


def one_patch(geometry: Geometry, generators: Sequence[np.ndarray], radius: float) -> Atlas:
    """The atlas of a fundamental polygon: the generators and their inverses are its transitions."""
    steps = [np.eye(3)]
    inverse = [0]
    for g in generators:
        back = geometry.inverse(g)
        involution = np.allclose(back, g)
        inverse += [len(steps)] if involution else [len(steps) + 1, len(steps)]
        steps += [g] if involution else [g, back]
    ends = np.array([-1] + [0] * (len(steps) - 1))
    return Atlas(geometry, np.array([radius]), ends, ends, np.array(inverse), np.array(steps))


def sphere() -> Orbifold:
    return Orbifold(one_patch(S2(), [], np.pi), 2, True, 4 * np.pi)


def projective_plane() -> Orbifold:
    return Orbifold(one_patch(S2(), [-np.eye(3)], np.pi / 2), 1, False, 2 * np.pi)


def torus() -> Orbifold:
    geometry = E2()
    steps = [geometry.translation(1.0, a) for a in (0.0, np.pi / 2)]
    return Orbifold(one_patch(geometry, steps, np.sqrt(0.5)), 0, True, 1.0)


def klein_bottle() -> Orbifold:
    geometry = E2()
    steps = [geometry.glide(1.0, 0.0), geometry.translation(1.0, np.pi / 2)]
    return Orbifold(one_patch(geometry, steps, np.sqrt(0.5)), 0, False, 1.0)


def octagon() -> Orbifold:
    """The Bolza surface: opposite sides of the regular octagon with angles pi/4, genus 2."""
    geometry = H2()
    steps = [geometry.translation(OCTAGON_STEP, k * np.pi / 4) for k in range(4)]
    return Orbifold(one_patch(geometry, steps, OCTAGON_RADIUS), -2, True, 4 * np.pi)


ALL = {f.__name__: f for f in (sphere, projective_plane, torus, klein_bottle, octagon)}


def in_two_patches(orbifold: Orbifold, change: np.ndarray) -> Orbifold:
    """An orbifold with one patch, with a second patch whose frame is `change` seen from the first.

    Both patches see all of X/H. From patch 1 the same group is the conjugate by `change`.
    """
    old, geometry = orbifold.atlas, orbifold.geometry
    steps, ends, inverse = [np.eye(3)], [(-1, -1)], [0]

    def add(g: np.ndarray, tail: int, head: int) -> int:
        steps.append(geometry.nearest_isometry(g))
        ends.append((tail, head))
        return len(steps) - 1

    back = geometry.inverse(change)
    inverse += [2, 1]
    add(change, 0, 1)
    add(back, 1, 0)
    first = len(steps)
    moved = len(old.tail) - 1
    for t in range(1, len(old.tail)):
        add(old.isometry[t], 0, 0)
    for t in range(1, len(old.tail)):
        add(back @ old.isometry[t] @ change, 1, 1)
    inverse += [first - 1 + i for i in old.inverse[1:]] + [first + moved - 1 + i for i in old.inverse[1:]]
    tail, head = np.array(ends).T
    radius = old.radius[0] + np.array([0.0, geometry.distance(geometry.origin, change[:, 0])])
    return replace(orbifold, atlas=Atlas(geometry, radius, tail, head, np.array(inverse), np.array(steps)))


def random_points(orbifold: Orbifold, count: int, rng: np.random.Generator) -> Points:
    """Random points within the radius of random patches, uniform in area where the patch is flat."""
    patch = rng.integers(orbifold.atlas.patch_count, size=count)
    radius = orbifold.atlas.radius[patch] * np.sqrt(rng.random(count))
    return Points(patch, orbifold.geometry.from_polar(radius, rng.uniform(0, 2 * np.pi, count)))


def brute_force_group(generators: np.ndarray, depth: int) -> np.ndarray:
    """All products of at most `depth` generators, each once (told apart by where they take the origin), (k, 3, 3)."""
    words = level = np.eye(3)[None]
    for _ in range(depth):
        level = (level[:, None] @ generators[None]).reshape(-1, 3, 3)
        words = np.concatenate([words, level])
    return words[np.unique(np.round(words[:, :, 0], 3) + 0.0, axis=0, return_index=True)[1]]


def glued(orbifold: Orbifold, corners: np.ndarray, size: float) -> Triangulation:
    """The triangulation of X/H, seen from one patch, from triangles in X that fill a fundamental domain.

    corners: (F, 3, 3), in the frame of patch 0; size: no two of them are farther apart. Corners that an element of H
    takes to one another become one vertex. The vertices in space are values of smooth functions on X/H.
    """
    geometry, atlas = orbifold.geometry, orbifold.atlas
    group = orbifold.lifts(0, size)[1]
    x = corners.reshape(-1, 3)
    site, lift = np.full(len(x), -1), np.zeros((len(x), 3, 3))
    chosen: list[np.ndarray] = []
    tree = cKDTree(x)
    for i, place in enumerate(x):
        if site[i] < 0:
            for g, members in zip(group, tree.query_ball_point(group @ place, 1e-8), strict=True):
                site[members], lift[members] = len(chosen), g
            chosen.append(place)
    points = np.array(chosen)
    mesh = Polyhedron.from_faces(in_space(orbifold, points), site.reshape(-1, 3))
    label = geometry.inverse(lift) @ lift[mesh.next]
    transition, table = with_labels(atlas, label)
    patch = np.zeros(len(points), dtype=np.intp)
    return Triangulation(replace(orbifold, atlas=table), mesh, patch, points, transition)


def with_labels(atlas: Atlas, label: np.ndarray) -> tuple[np.ndarray, Atlas]:
    """The index of every label in the table of transitions of patch 0, which grows by those that it lacks."""
    known = [atlas.isometry[0]]
    found = np.full(len(label), -1)
    pending = np.arange(len(label))
    while len(pending):
        close = np.abs(label[pending] - known[-1]).max(axis=(1, 2)) < 1e-7
        found[pending[close]] = len(known) - 1
        pending = pending[~close]
        if len(pending):
            known.append(label[pending[0]])
    table = np.array(known)
    back = atlas.geometry.inverse(table)
    inverse = np.abs(back[:, None] - table[None]).max(axis=(2, 3)).argmin(axis=1)
    ends = np.array([-1] + [0] * (len(known) - 1))
    return found, replace(atlas, tail=ends, head=ends, inverse=inverse, isometry=table)


def in_space(orbifold: Orbifold, x: np.ndarray) -> np.ndarray:
    """Three smooth functions on X/H at points of patch 0: sums of exp(-3 c) over the group about three fixed points.

    On the sphere the points themselves.
    """
    geometry = orbifold.geometry
    if orbifold.euler_characteristic == 2:
        return x
    about = geometry.from_polar([0.2, 0.5, 0.6], [0.3, 2.2, 4.4])
    group = orbifold.lifts(0, 6.0)[1]
    images = np.einsum("gij,pj->pgi", group, about)
    return np.exp(-3 * geometry.versine(x[:, None, None], images)).sum(axis=2)


def refined(geometry: Geometry, corners: np.ndarray, times: int) -> np.ndarray:
    """Every triangle cut into four at the midpoints of its sides, `times` times over."""
    for _ in range(times):
        a, b, c = np.moveaxis(corners, 1, 0)
        ab, bc, ca = (geometry.geodesic(p, q, 0.5) for p, q in ((a, b), (b, c), (c, a)))
        parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        corners = np.concatenate([np.stack(part, axis=1) for part in parts])
    return corners


def fan(geometry: Geometry, radius: float, sides: int, turn: float = 0.0) -> np.ndarray:
    """A regular polygon about the origin as triangles."""
    rim = geometry.from_polar(radius, turn + 2 * np.pi * np.arange(sides) / sides)
    centre = np.broadcast_to(geometry.origin, rim.shape)
    return np.stack([centre, rim, np.roll(rim, -1, axis=0)], axis=1)


@cache
def triangulated(name: str, times: int = 3) -> Triangulation:
    """A triangulation of one of the surfaces above, `times` times refined from a few triangles."""
    orbifold = ALL[name]()
    geometry = orbifold.geometry
    if geometry.curvature > 0:
        half = fan(geometry, np.pi / 2, 4)
        corners = refined(
            geometry, half if name == "projective_plane" else np.concatenate([half, -half[:, ::-1]]), times
        )
        return glued(orbifold, corners, np.pi)
    if geometry.curvature == 0:
        corners = fan(geometry, np.sqrt(0.5), 4, np.pi / 4)
    else:
        corners = fan(geometry, OCTAGON_RADIUS, 8, np.pi / 8)
    return glued(orbifold, refined(geometry, corners, times), 2.01 * orbifold.atlas.radius[0])


def in_two_frames(triangulation: Triangulation) -> Triangulation:
    """The same map, with every second vertex in the frame of another patch (see `in_two_patches`)."""
    orbifold, geometry = triangulation.orbifold, triangulation.orbifold.geometry
    change = geometry.translation(0.3, 0.5) @ geometry.reflection(0.4)
    atlas, mesh = orbifold.atlas, triangulation.polyhedron
    patch = np.arange(len(mesh.vertices)) % 2
    frame = np.stack([np.eye(3), geometry.inverse(change)])
    points = geometry.act(frame[patch], triangulation.points)
    old = atlas.isometry[triangulation.transition]
    tail, head = patch[mesh.tail], patch[mesh.head]
    label = frame[tail] @ old @ geometry.inverse(frame[head])
    ends = np.stack([tail, head], axis=1)
    transition = np.zeros(len(tail), dtype=np.intp)
    table, sides = [np.eye(3)], [(-1, -1)]
    for i in range(len(label)):
        same = tail[i] == head[i]
        if same and np.abs(label[i] - np.eye(3)).max() < 1e-7:
            continue
        for k in range(1, len(table)):
            if sides[k] == tuple(ends[i]) and np.abs(table[k] - label[i]).max() < 1e-7:
                transition[i] = k
                break
        else:
            transition[i] = len(table)
            table.append(label[i])
            sides.append(tuple(ends[i]))
    isometry = np.array(table)
    tails, heads = np.array(sides).T
    back = geometry.inverse(isometry)
    inverse = np.zeros(len(table), dtype=np.intp)
    for k in range(1, len(table)):
        mates = np.flatnonzero((tails == heads[k]) & (heads == tails[k]))
        inverse[k] = mates[np.abs(isometry[mates] - back[k]).max(axis=(1, 2)).argmin()]
    radius = atlas.radius[0] + np.array([0.0, 0.3])
    two = replace(orbifold, atlas=Atlas(geometry, radius, tails, heads, inverse, isometry))
    return Triangulation(two, mesh, patch, points, transition)
