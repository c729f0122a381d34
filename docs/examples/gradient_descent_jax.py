"""Fit a surface by gradient descent in JAX: coefficients and places on X/H move together."""

from __future__ import annotations

from functools import partial

import jax
import numpy as np

from orbiframe import Points, fit
from orbiframe.surfaces import jax_surface

jax.config.update("jax_enable_x64", True)
surface = fit("dataset:torus", size=150).surface
rng = np.random.default_rng(0)

# Points on a torus that is taller than ours, of which we do not know where on X/H they belong.
around, across = rng.uniform(0, 2 * np.pi, (2, 600))
ring = 1 + 0.4 * np.cos(across)
wanted = np.stack([ring * np.cos(around), ring * np.sin(around), 0.6 * np.sin(across)], axis=1)

evaluate = jax_surface(surface)
begin, _ = surface.nearest(wanted)


@jax.jit
@jax.value_and_grad
def loss(moving):
    """The mean square of the distances of the points, by the coefficients and the places."""
    coefficients, x = moving
    return ((evaluate(coefficients, Points(begin.patch, x)) - wanted) ** 2).sum(axis=1).mean()


def moved(place, mean, square, share):
    """A step of Adam."""
    return place - share * mean / (square**0.5 + 1e-8)


moving = (surface.coefficients, begin.x)
mean = square = jax.tree.map(np.zeros_like, moving)
for step in range(201):
    value, slope = loss(moving)
    mean = jax.tree.map(lambda m, g: 0.9 * m + 0.1 * g, mean, slope)
    square = jax.tree.map(lambda s, g: 0.999 * s + 0.001 * g**2, square, slope)
    share = 2e-3 * (1 - 0.999 ** (step + 1)) ** 0.5 / (1 - 0.9 ** (step + 1))
    moving = jax.tree.map(partial(moved, share=share), moving, mean, square)
    if step % 50 == 0:
        print(f"step {step}: root of the mean square {value**0.5:.1e}")
