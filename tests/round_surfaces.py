"""Round surfaces that are fitted once: a torus and a sphere, with what is known of them."""

from __future__ import annotations

from functools import cache

import numpy as np
import scipy.linalg
from fitted import REGISTRY, config, grid

from orbiframe import Polyhedron, fit
from orbiframe.meshes.subdivision import refine
from orbiframe.surfaces.surface_forms import SurfaceForms

SMALL = 0.4


def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    ring = 1 + SMALL * np.cos(v)
    return np.stack([ring * np.cos(u), ring * np.sin(u), SMALL * np.sin(v)], axis=1)


@cache
def torus():
    """The torus of radii 1 and 0.4, round to 1e-6."""
    return fit(grid(48, 24, place), config(1500, "basis.name=ps6"), REGISTRY).surface


@cache
def forms(basis: str, size: int) -> SurfaceForms:
    surface = torus()
    return SurfaceForms.of(surface, REGISTRY.load("basis", basis)(surface.orbifold, surface.triangulation, size=size))


def round_torus_eigenvalues(r: float) -> np.ndarray:
    """By Fourier series: u(v) e^{iku}, -(R u')' / (r^2 R) + k^2 u / R^2 = lambda u with R = 1 + r cos v."""
    n = 255
    v = 2 * np.pi * np.arange(n) / n
    wave = np.fft.fftfreq(n, 1 / n)
    derive = np.real(np.fft.ifft(1j * wave[:, None] * np.fft.fft(np.eye(n), axis=0), axis=0))
    ring = 1 + r * np.cos(v)
    stiff = derive.T @ (ring[:, None] * derive) / r**2
    values = []
    for k in range(6):
        both = scipy.linalg.eigh(stiff + np.diag(k**2 / ring), np.diag(ring), eigvals_only=True)
        values += list(both[1:8]) if k == 0 else 2 * list(both[:8])
    return np.sort([0.0, *values])


RADIUS = 2.0


@cache
def sphere():
    """The sphere of radius 2, to some 1e-5."""
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    fine = refine(Polyhedron.from_faces(corners, faces), 8).polyhedron
    on_sphere = RADIUS * fine.vertices / np.linalg.norm(fine.vertices, axis=1, keepdims=True)
    options = "basis.name=ps6", "data.means=smooth"
    return fit(fine.with_vertices(on_sphere), config(500, *options), REGISTRY).surface
