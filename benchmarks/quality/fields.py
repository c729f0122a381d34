"""Fields: functions of a point that vanish on a smooth closed surface, written as plain formulas for `jax`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from quality.automatic import jax, jnp

if TYPE_CHECKING:
    from jax import Array

    Field = Callable[[Array], Array]


def torus(big: float, small: float) -> Field:
    """A torus of revolution about the z axis."""
    return lambda x: jnp.hypot(jnp.hypot(x[0], x[1]) - big, x[2]) - small


def ellipsoid(*axes: float) -> Field:
    """An ellipsoid with these half axes."""
    return lambda x: jnp.sum((x / jnp.array(axes)) ** 2) - 1


def melted_tori(centres: list[tuple[float, float]], small: float = 0.4, blend: float = 10.0) -> Field:
    """Tori of radius 1 about these centres in the plane z = 0, melted together: a smooth least distance."""
    places = np.array(centres)

    def field(x: Array) -> Array:
        offset = x[:2] - places
        distance = jnp.hypot(jnp.hypot(offset[:, 0], offset[:, 1]) - 1, x[2])
        return -jax.nn.logsumexp(-blend * (distance - small)) / blend

    return field


def tanglecube(x: Array) -> Array:
    """A quartic of genus 5: the sum of x^4 - 5 x^2 over the coordinates is -11.8."""
    return jnp.sum(x**4 - 5 * x**2) + 11.8


def schwarz(x: Array) -> Array:
    """Eight chambers of the nodal surface of Schwarz' minimal surface P, smoothly cut off by a sphere."""
    return _within_ball(-jnp.sum(jnp.cos(x - np.pi)), x, 6.0)


def _within_ball(value: Array, x: Array, radius: float, blend: float = 6.0) -> Array:
    ball = (x @ x / radius**2 - 1) * radius / 2
    return jax.nn.logsumexp(blend * jnp.stack([value, ball])) / blend


def starfish(x: Array) -> Array:
    """A body with five bent arms: Gaussians along segments, added up."""
    angles = 2 * np.pi * np.arange(5) / 5
    along = np.linspace(0.3, 1, 14)[None, :, None] * np.array([2.1, 1.6, 1.9, 1.7, 2.0])[:, None, None]
    straight = np.stack([np.sin(angles), np.cos(angles), 0 * angles], axis=1)[:, None] * along
    arms = jnp.array((straight + np.array([0, 0, 0.2]) * along**2).reshape(-1, 3))
    body = jnp.exp(-jnp.sum((x / jnp.array([0.7, 0.7, 0.4])) ** 2))
    return 0.4 - body - 0.6 * jnp.sum(jnp.exp(-jnp.sum((x - arms) ** 2, axis=1) / 0.18**2))


def blob(x: Array) -> Array:
    """Four balls melted together."""
    places = jnp.array([[0, 0, 0], [1.3, 0.2, 0.1], [-0.7, 1.0, 0.2], [0.1, -0.5, 1.2]])
    radii = jnp.array([0.9, 0.6, 0.5, 0.7])
    return 0.6 - jnp.sum(jnp.exp(-jnp.sum((x - places) ** 2, axis=1) / radii**2))
