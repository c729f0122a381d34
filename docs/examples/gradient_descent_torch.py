"""Fit a surface by gradient descent in PyTorch: coefficients and places on X/H move together."""

from __future__ import annotations

import numpy as np
import torch

from orbiframe import Points, fit
from orbiframe.surfaces import torch_surface

surface = fit("dataset:torus", size=150).surface
rng = np.random.default_rng(0)

# Points on a torus that is taller than ours, of which we do not know where on X/H they belong.
around, across = rng.uniform(0, 2 * np.pi, (2, 600))
ring = 1 + 0.4 * np.cos(across)
wanted = torch.tensor(np.stack([ring * np.cos(around), ring * np.sin(around), 0.6 * np.sin(across)], axis=1))

evaluate = torch_surface(surface)
begin, _ = surface.nearest(wanted.numpy())
coefficients = torch.tensor(surface.coefficients, requires_grad=True)
x = torch.tensor(begin.x, requires_grad=True)
optimizer = torch.optim.Adam([coefficients, x], lr=2e-3)
for step in range(201):
    optimizer.zero_grad()
    distance = (evaluate(coefficients, Points(begin.patch, x)) - wanted).square().sum(dim=1)
    loss = distance.mean()
    loss.backward()
    optimizer.step()
    if step % 50 == 0:
        print(f"step {step}: root of the mean square {loss.item() ** 0.5:.1e}")
