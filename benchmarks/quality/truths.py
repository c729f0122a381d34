"""Truths: smooth surfaces in closed form, with the nearest point, the normal and the curvature there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from orbiframe import Polyhedron
from quality.automatic import jax
from quality.nets import surface_net

if TYPE_CHECKING:
    from jax import Array

    from quality.fields import Field

Floats = NDArray[np.float64]

_STEPS = 12


def padded(function: Callable[[Floats], Any]) -> Callable[[Floats], Any]:
    """A function compiled for points (n, k), made longer up to a power of two: few lengths, few compilations."""
    compiled = jax.jit(jax.vmap(function))

    def called(x: Floats) -> Any:
        count = len(x)
        full = np.concatenate([x, np.repeat(x[:1], 2 ** int(np.ceil(np.log2(max(count, 1024)))) - count, axis=0)])
        return jax.tree.map(lambda a: np.asarray(a)[:count], compiled(full))

    return called


class Feet(NamedTuple):
    """Nearest points (n, 3) of a truth, unit normals (n, 3) up to sign, and Gaussian curvature (n,)."""

    points: Floats
    normals: Floats
    gaussian: Floats


class Truth(Protocol):
    """A closed surface in closed form. immersed: whether it passes through itself."""

    immersed: bool

    @property
    def samples(self) -> Floats:
        """Points (n, 3) spread over all of it."""

    def feet(self, x: Floats, normals: Floats | None = None) -> Feet:
        """The nearest points to x (n, 3); of those alone whose normals agree within 60 degrees, if some are given."""


@dataclass(frozen=True, eq=False)
class Level(Truth):
    """The zero set of a field inside of a box; step: of the grid from which `samples` are made."""

    field: Field
    low: Floats
    high: Floats
    step: float
    immersed: bool = False

    @cached_property
    def _value(self) -> Callable[[Floats], Floats]:
        return padded(self.field)

    @cached_property
    def _slope(self) -> Callable[[Floats], tuple[Floats, Floats]]:
        return padded(jax.value_and_grad(self.field))

    @cached_property
    def _bend(self) -> Callable[[Floats], Floats]:
        return padded(jax.hessian(self.field))

    def net(self, step: float) -> Polyhedron:
        """A mesh of quadrilaterals with its vertices on the level set, to rounding."""
        net = surface_net(self._value, self.low, self.high, step)
        return net.with_vertices(self.onto(net.vertices))

    def onto(self, x: Floats, steps: int = 20) -> Floats:
        """Points moved along gradients onto the level set."""
        for _ in range(steps):
            value, slope = self._slope(x)
            x = x - (value / (slope**2).sum(axis=1))[:, None] * slope
        return x

    @cached_property
    def samples(self) -> Floats:
        """The vertices of a fine net."""
        return self.net(self.step).vertices

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.samples)

    def feet(self, x: Floats, normals: Floats | None = None) -> Feet:
        """From the nearest sample, steps in the tangent plane, each brought back to the level set."""
        del normals
        foot = self.samples[self._tree.query(x)[1]]
        for _ in range(_STEPS):
            normal = _unit(self._slope(foot)[1])
            gap = x - foot
            foot = self.onto(foot + gap - (gap * normal).sum(axis=1)[:, None] * normal, 3)
        slope, bend = self._slope(foot)[1], self._bend(foot)
        return Feet(foot, _unit(slope), _gaussian_of_level(slope, bend))


@dataclass(frozen=True, eq=False)
class Chart(Truth):
    """The image of a plane of parameters; grid: parameters (n, 2) spread over it, in any order."""

    place: Callable[[Array], Array]
    grid: Floats
    immersed: bool = False

    @cached_property
    def _jet(self) -> Callable[[Floats], tuple[Floats, Floats, Floats]]:
        first = jax.jacfwd(self.place)
        second = jax.jacfwd(first)
        return padded(lambda u: (self.place(u), first(u), second(u)))

    def points(self, u: Floats) -> Floats:
        """The points at parameters."""
        return self._jet(u)[0]

    @cached_property
    def samples(self) -> Floats:
        """The points of the grid."""
        return self.points(self.grid)

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.samples)

    @cached_property
    def _normals(self) -> Floats:
        return _shape(*self._jet(self.grid)[1:])[0]

    def feet(self, x: Floats, normals: Floats | None = None) -> Feet:
        """Newton's method on the parameters from the nearest sample whose normal agrees."""
        u = self.grid[self._nearest(x, normals)]
        for _ in range(_STEPS):
            value, first, second = self._jet(u)
            gap = x - value
            metric = np.einsum("nia,nib->nab", first, first)
            hessian = metric - np.einsum("ni,niab->nab", gap, second)
            safe = np.linalg.det(hessian) > 0.05 * np.linalg.det(metric)
            matrix = np.where(safe[:, None, None], hessian, metric)
            step = np.linalg.solve(matrix, np.einsum("nia,ni->na", first, gap)[..., None])[..., 0]
            u = u + step
        value, first, second = self._jet(u)
        return Feet(value, *_shape(first, second))

    def _nearest(self, x: Floats, normals: Floats | None) -> NDArray[np.intp]:
        near = self._tree.query(x, 16)[1]
        if normals is None:
            return near[:, 0]
        agree = np.abs(np.einsum("nki,ni->nk", self._normals[near], normals)) > 0.5
        return near[np.arange(len(x)), np.argmax(agree, axis=1)]


def _unit(x: Floats) -> Floats:
    return x / np.linalg.norm(x, axis=-1, keepdims=True)


def _gaussian_of_level(slope: Floats, bend: Floats) -> Floats:
    """K = -det [[H, g], [g^T, 0]] / |g|^4 (Goldman, Curvature formulas for implicit curves and surfaces, 2005)."""
    framed = np.zeros((len(slope), 4, 4))
    framed[:, :3, :3], framed[:, :3, 3], framed[:, 3, :3] = bend, slope, slope
    return -np.linalg.det(framed) / (slope**2).sum(axis=1) ** 2


def _shape(first: Floats, second: Floats) -> tuple[Floats, Floats]:
    """Unit normals and Gaussian curvature from derivatives (n, 3, 2) and (n, 3, 2, 2)."""
    normal = _unit(np.cross(first[:, :, 0], first[:, :, 1]))
    form = np.einsum("ni,niab->nab", normal, second)
    return normal, np.linalg.det(form) / np.linalg.det(np.einsum("nia,nib->nab", first, first))
