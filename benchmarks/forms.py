"""Period matrices beside closed forms: errors, bounds and seconds. Run `python benchmarks/forms.py`."""

from __future__ import annotations

import time

import numpy as np
from orbiframe_invariants.named_words import opposite_sides
from orbiframe_invariants.periods import group_periods

from orbiframe import Config, Polyhedron, Registry, Word, fit
from orbiframe.groups import FundamentalPolygon, Group, PolygonGroup, regular_polygon
from orbiframe.splines import ElementBasis
from orbiframe.surfaces import HarmonicForms, period_matrix
from orbiframe.triangulations import GeodesicTriangulation

REGISTRY = Registry.discover()
BERNSTEIN = REGISTRY.load("basis", "bernstein")


def family(domain: GeodesicTriangulation, degree: int) -> ElementBasis:
    """Continuous polynomials."""
    found: ElementBasis = BERNSTEIN(domain.orbifold, domain, degree=degree)
    return found


def torus(tau: complex) -> Group:
    """The flat torus of the lattice 1, tau."""
    corners = np.array([0, 1, 1 + tau, tau]) - (1 + tau) / 2
    vertices = np.stack([np.ones(4), corners.real, corners.imag], axis=1)
    return PolygonGroup(FundamentalPolygon(REGISTRY.geometry(0), vertices, Word.parse("abAB")))


def bolza() -> tuple[Group, np.ndarray]:
    """The group, and the matrix of y^2 = x (x^4 - 1): Birkenhake and Lange, Complex Abelian Varieties, 11.7."""
    eta = (1 + 2j * np.sqrt(2)) / 3
    group = PolygonGroup(regular_polygon(REGISTRY.geometry(-1), opposite_sides(8)))
    return group, np.array([[eta, (eta - 1) / 2], [(eta - 1) / 2, eta]]) - np.eye(2)


def round_torus(big: float = 3.0, small: float = 1.0) -> Polyhedron:
    """A torus of revolution of 5,760 quads."""
    i, j = np.divmod(np.arange(120 * 48), 48)
    u, v = 2 * np.pi * i / 120, 2 * np.pi * j / 48
    right, up = (i + 1) % 120, (j + 1) % 48
    ring = big + small * np.cos(v)
    faces = np.stack([i * 48 + j, right * 48 + j, right * 48 + up, i * 48 + up], axis=1)
    return Polyhedron.from_faces(np.stack([ring * np.cos(u), ring * np.sin(u), small * np.sin(v)], axis=1), faces)


def upright(tau: complex) -> complex:
    """In the fundamental domain of the modular group."""
    while abs(tau - np.round(tau.real)) < 1 - 1e-9:
        tau = -1 / (tau - np.round(tau.real))
    return complex(tau - np.round(tau.real))


def main() -> None:
    """One line for each: how far the matrix is off, what its bound says, the degree, the seconds."""
    cases = {f"torus, tau = {tau:.4g}": (torus(tau), np.array([[tau]])) for tau in (1j, 2.5j, 0.1j, 0.31 + 0.77j)}
    for name, (group, wanted) in {**cases, "Bolza": bolza()}.items():
        start = time.perf_counter()
        found = group_periods(group, family)
        seconds, off = time.perf_counter() - start, np.abs(found.matrix - wanted).max()
        print(f"{name:<28} off {off:.1e}  bound {found.error:.1e}  degree {found.forms.basis.degree}  {seconds:.2f} s")
    for size in (250, 500, 1000):
        config = Config.load(overrides=["basis.name=ps6", f"basis.size={size}", "output.refine=1"])
        surface = fit(round_torus(), config, REGISTRY).surface
        start = time.perf_counter()
        tau = upright(complex(period_matrix(HarmonicForms.on_surface(surface)).matrix[0, 0]))
        off, seconds = abs(tau - 1j * np.sqrt(8)), time.perf_counter() - start
        print(f"round torus, {surface.basis.size:>4} functions   off {off:.1e}  {'':14}  degree 6  {seconds:.2f} s")


if __name__ == "__main__":
    main()
