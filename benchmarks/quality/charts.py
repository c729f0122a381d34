"""Charts: surfaces given by parameters, and meshes whose vertices lie on them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, Delaunay

from orbiframe import Polyhedron
from orbiframe.meshes import refine
from quality.automatic import jax, jnp
from quality.truths import Chart

if TYPE_CHECKING:
    from jax import Array

    Place = Callable[[Array], Array]

Floats = NDArray[np.float64]
FULL = 2 * np.pi
SQRT5 = 5**0.5


def torus(u: Array) -> Array:
    """The torus of revolution with radii 3 and 1."""
    ring = 3 + jnp.cos(u[1])
    return jnp.stack([ring * jnp.cos(u[0]), ring * jnp.sin(u[0]), jnp.sin(u[1])])


def figure_eight_bottle(u: Array) -> Array:
    """A figure of eight that turns over once on its way round: a Klein bottle that passes through itself."""
    c, s = jnp.cos(u[0] / 2), jnp.sin(u[0] / 2)
    ring = 2.5 + c * jnp.sin(u[1]) - s * jnp.sin(2 * u[1])
    return jnp.stack([ring * jnp.cos(u[0]), ring * jnp.sin(u[0]), s * jnp.sin(u[1]) + c * jnp.sin(2 * u[1])])


def lawson_bottle(u: Array) -> Array:
    """Lawson's minimal Klein bottle tau(2, 1) of the 3-sphere, projected stereographically."""
    x, y = u[0] / 2, u[1]
    p = jnp.stack(
        [jnp.cos(2 * x) * jnp.cos(y), jnp.sin(2 * x) * jnp.cos(y), jnp.cos(x) * jnp.sin(y), jnp.sin(x) * jnp.sin(y)]
    )
    turned = _AWAY @ p
    return turned[1:] / (1 - turned[0])


# Orthonormal; the first row is a point of the 3-sphere far from Lawson's bottle (found by trying 20,000).
_AWAY = np.linalg.qr(np.column_stack([[-0.24917, -0.52261, -0.79506, 0.18078], np.eye(4)[:, :3]]))[0].T
_AWAY *= np.sign(_AWAY[0] @ [-0.24917, -0.52261, -0.79506, 0.18078])


def knotted_tube(u: Array) -> Array:
    """A tube of radius 0.4 about a trefoil knot."""

    def core(t: Array) -> Array:
        return jnp.stack([jnp.sin(t) + 2 * jnp.sin(2 * t), jnp.cos(t) - 2 * jnp.cos(2 * t), -jnp.sin(3 * t)])

    velocity = jax.jacfwd(core)
    side = jnp.cross(velocity(u[0]), jax.jacfwd(velocity)(u[0]))
    binormal = side / jnp.linalg.norm(side)
    tangent = velocity(u[0]) / jnp.linalg.norm(velocity(u[0]))
    return core(u[0]) + 0.4 * (jnp.cos(u[1]) * jnp.cross(binormal, tangent) + jnp.sin(u[1]) * binormal)


def boy(u: Array) -> Array:
    """Boy's surface of Bryant and Kusner: the inverse of a minimal surface; u and its antipode -1/conj(u) are one."""
    w = u[0] + 1j * u[1]
    pole = w**6 + SQRT5 * w**3 - 1
    back = jnp.conj(pole)
    size = jnp.real(pole * back)
    g = jnp.stack(
        [
            -1.5 * jnp.imag(w * (1 - w**4) * back),
            -1.5 * jnp.real(w * (1 + w**4) * back),
            jnp.imag((1 + w**6) * back) - size / 2,
        ]
    )
    return g * size / jnp.sum(g**2)


def wound(place: Place, around: int, across: int, mirrored: bool = False) -> Polyhedron:
    """A grid of quadrilaterals around and across; mirrored: once around, across runs backwards (a Klein bottle)."""
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    u = np.stack([i * FULL / around, j * FULL / across], axis=-1).reshape(-1, 2)
    return Polyhedron.from_faces(np.asarray(jax.vmap(place)(u)), _wound_faces(around, across, mirrored))


def _wound_faces(around: int, across: int, mirrored: bool) -> NDArray[np.intp]:
    i, j = (a.ravel() for a in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
    number = lambda a, b: np.where(a < around, a * across + b % across, ((-b if mirrored else b) % across))  # noqa: E731
    return np.stack([number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)], axis=1)


def scattered_torus(count: int, seed: int = 0) -> Polyhedron:
    """So many vertices at random on the torus of radii 3 and 1, none too near to others, with Delaunay triangles."""
    points = _scattered(np.random.default_rng(seed), count, _torus_candidates)
    high = _conformal(points[:, 1])
    flat = np.stack([points[:, 0] / FULL, (high - _conformal(-np.pi)) / _PERIOD], axis=1) % 1
    copies = np.array([(a, b) for a in (0, -1, 1) for b in (0, -1, 1)])
    plane = (flat + copies[:, None]).reshape(-1, 2) * np.array([FULL, _PERIOD])
    corners = Delaunay(plane).simplices
    middle = plane[corners].mean(axis=1) / np.array([FULL, _PERIOD])
    inner = ((middle >= 0) & (middle < 1)).all(axis=1)
    return Polyhedron.from_faces(np.asarray(jax.vmap(torus)(points)), corners[inner] % count)


def _conformal(v: Floats | float) -> Floats:
    """The integral of 1/(3 + cos v) from 0, for |v| at most pi."""
    return 2 / np.sqrt(8) * np.arctan(np.sqrt(0.5) * np.tan(np.asarray(v) / 2))


_PERIOD = FULL / np.sqrt(8)


def _torus_candidates(rng: np.random.Generator, count: int) -> tuple[Floats, Floats]:
    u = rng.uniform(0, FULL, (4 * count, 2))
    u = u[rng.uniform(0, 4, len(u)) < 3 + np.cos(u[:, 1])][:count]
    u[:, 1] = (u[:, 1] + np.pi) % FULL - np.pi
    return u, np.asarray(jax.vmap(torus)(u))


def _sphere_candidates(rng: np.random.Generator, count: int) -> tuple[Floats, Floats]:
    x = rng.normal(size=(count, 3))
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return x, x


def _scattered(rng: np.random.Generator, count: int, candidates: Callable[..., tuple[Floats, Floats]]) -> Floats:
    """Best candidates of a small pool, one after another: irregular, but without clusters."""
    keys, places = candidates(rng, 6 * count)
    chosen, distance = [0], np.linalg.norm(places - places[0], axis=1)
    for _ in range(count - 1):
        some = rng.choice(len(places), 24, replace=False)
        best = some[np.argmax(distance[some])]
        chosen.append(best)
        distance = np.minimum(distance, np.linalg.norm(places - places[best], axis=1))
    return keys[chosen]


def scattered_ellipsoid(count: int, *axes: float, seed: int = 0) -> Polyhedron:
    """So many vertices at random on an ellipsoid, none too near to others, Delaunay on the sphere."""
    points = _scattered(np.random.default_rng(seed), count, _sphere_candidates)
    return Polyhedron.from_faces(points * np.array(axes), _outward(points))


def _outward(points: Floats) -> NDArray[np.intp]:
    corners = ConvexHull(points).simplices.astype(np.intp)
    a, b, c = np.moveaxis(points[corners], 1, 0)
    back = np.einsum("ni,ni->n", np.cross(b - a, c - a), a) < 0
    corners[back] = corners[back][:, ::-1]
    return corners


def icosphere(density: int) -> Polyhedron:
    """An icosahedron with every face in density^2 triangles, moved onto the unit sphere."""
    gold = (1 + SQRT5) / 2
    ring = np.array([[0, a, b * gold] for a in (-1, 1) for b in (-1, 1)])
    corners = np.concatenate([np.roll(ring, k, axis=1) for k in range(3)])
    mesh = refine(Polyhedron.from_faces(corners, _outward(corners)), density).polyhedron
    return mesh.with_vertices(mesh.vertices / np.linalg.norm(mesh.vertices, axis=1, keepdims=True))


def boy_mesh(density: int) -> Polyhedron:
    """Boy's surface with an icosphere's vertices, antipodes made one."""
    sphere = icosphere(density)
    x = sphere.vertices
    key = np.round(x, 9) + 0.0
    flip = (key[:, 2] < 0) | ((key[:, 2] == 0) & ((key[:, 0] < 0) | ((key[:, 0] == 0) & (key[:, 1] < 0))))
    half, number = np.unique(np.where(flip[:, None], -key, key) + 0.0, axis=0, return_inverse=True)
    faces = np.sort(number.reshape(-1)[sphere.triangles], axis=1)
    return Polyhedron.from_faces(np.asarray(jax.vmap(boy)(_stereographic(half))), np.unique(faces, axis=0))


def _stereographic(x: Floats) -> Floats:
    """From the upper half of the sphere into the unit disc."""
    return x[:, :2] / (1 + x[:, 2:])


def _rectangle(around: int, across: int) -> Floats:
    i, j = np.meshgrid(np.arange(around) / around, np.arange(across) / across, indexing="ij")
    return FULL * np.stack([i, j], axis=-1).reshape(-1, 2)


TORUS = Chart(torus, _rectangle(240, 80))
FIGURE_EIGHT = Chart(figure_eight_bottle, _rectangle(200, 120), immersed=True)
LAWSON = Chart(lawson_bottle, _rectangle(160, 160), immersed=True)
KNOT = Chart(knotted_tube, _rectangle(500, 40))
_HALF = icosphere(48).vertices
BOY = Chart(boy, _stereographic(_HALF[_HALF[:, 2] >= 0]), immersed=True)
