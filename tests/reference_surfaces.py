"""Small orbifolds in closed form, and the same ones in other patches and frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from orbiframe_geometries.e2 import E2
from orbiframe_geometries.h2 import H2
from orbiframe_geometries.s2 import S2

from orbiframe.atlas import Atlas, Points
from orbiframe.geometry import Geometry
from orbiframe.orbifold import Orbifold

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
