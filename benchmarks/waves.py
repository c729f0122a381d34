"""Spectra, equations and distances beside what is known and beside peers. Run `python benchmarks/waves.py`.

Published eigenvalues of hyperbolic surfaces; Poisson's equation on a torus in space with a solution made up; distances
beside the exact ones of pygeodesic and the heat method of potpourri3d; then `fields.py`, minimal energy beside scipy's
thin plates. Meshes of others are taken from the folder given by `--meshes`, if any.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Iterator
from pathlib import Path

import fields
import numpy as np

from orbiframe import Config, OrbifoldSurface, Polyhedron, Registry, fit, read
from orbiframe.delaunay import polygon_triangulation
from orbiframe.groups import orbifold_group
from orbiframe.meshes import refine, triangulated
from orbiframe.surfaces import SurfaceForms, geodesic_distance, poisson, spectrum
from orbiframe.words import ConwaySymbol

REGISTRY = Registry.discover()
ROOT = Path(__file__).parents[1]
SMALL = 0.4  # of the torus, whose big radius is 1
VERTICES = 10_000
# Bolza: Strohmaier and Uski (2013), who have 47 digits; the others to the digits that are known here from elsewhere.
KNOWN = {
    "bolza": (3.8388872588421995185866, 3, 1e-12),
    "klein-quartic": (2.6779329, 8, 1e-7),
    "237": (44.888353604, 1, 1e-10),
}
STRANGERS = ("gc_bob_small.ply", "gc_spot.ply")


def torus(along: int, across: int) -> Polyhedron:
    """A torus of triangles."""
    i, j = np.divmod(np.arange(along * across), across)
    u, v = 2 * np.pi * i / along, 2 * np.pi * j / across
    ring = 1 + SMALL * np.cos(v)
    x = np.stack([ring * np.cos(u), ring * np.sin(u), SMALL * np.sin(v)], axis=1)
    right, up = (i + 1) % along, (j + 1) % across
    corners = i * across + j, right * across + j, right * across + up, i * across + up
    faces = np.concatenate([np.stack([corners[k] for k in order], axis=1) for order in ((0, 1, 2), (0, 2, 3))])
    return Polyhedron.from_faces(x, faces.tolist())


def fitted(mesh: Polyhedron, size: int) -> OrbifoldSurface:
    """The smooth surface of ps6."""
    return fit(mesh, Config.load(overrides=["basis.name=ps6", f"basis.size={size}"]), REGISTRY).surface


def hyperbolic() -> None:
    """First eigenvalues beside the published ones."""
    from orbiframe_invariants.laplace_spectrum import laplace_spectrum
    from orbiframe_invariants.named_words import word_named

    bernstein = REGISTRY.load("basis", "bernstein")
    for name, (exact, multiplicity, wanted) in KNOWN.items():
        if name.isdigit():
            group = orbifold_group(REGISTRY.geometry(-1), ConwaySymbol.parse(name))
        else:
            group = REGISTRY.load("group", "regular-polygon")(REGISTRY.geometry(-1), word_named(name))
        start = time.perf_counter()
        _, first = laplace_spectrum(
            polygon_triangulation(group), lambda d, k: bernstein(d.orbifold, d, degree=k), 2, tolerance=1e-12
        )
        spent, off = time.perf_counter() - start, abs(first.value / exact - 1)
        sound = off < wanted and first.multiplicity == multiplicity
        print(
            f"{name:<14} {first.value:.13f} ({first.multiplicity}), said {first.error:.1e}, published {exact:.13g}, "
            f"off by {off:.0e} of it, {spent:.1f} s: {_verdict(sound)}"
        )


def torus_in_space() -> None:
    """Poisson's equation with a solution made up, and the first eigenvalues beside a Fourier series."""
    surface = fitted(torus(48, 24), 1500)
    errors = {}
    for name, sizes, order in (("ps2", (400, 1600), 3), ("ps3", (400, 1600), 4)):
        family = REGISTRY.load("basis", name)
        errors = {
            size: _poisson_error(surface, family(surface.orbifold, surface.triangulation, size=size)) for size in sizes
        }
        measured = math.log2(errors[sizes[0]] / errors[sizes[1]])
        said = ", ".join(f"{size} functions {error:.1e}" for size, error in errors.items())
        print(
            f"Poisson, {name}  error {said}: order {measured:.2f}, promised {order}: {_verdict(measured > order - 0.3)}"
        )
    found = spectrum(SurfaceForms.of(surface), 8)
    exact = _torus_eigenvalues()[:8]
    off = np.abs(found.values - exact) / np.maximum(exact, 1)
    print(f"torus in space  eigenvalues {off.max():.0e} off a Fourier series, said {found.error.max():.0e}")


def _poisson_error(surface: OrbifoldSurface, basis: object) -> float:
    forms = SurfaceForms.of(surface, basis)  # type: ignore[arg-type]
    x, weights = surface.evaluate(forms.points), forms.weights
    u, v = np.arctan2(x[:, 1], x[:, 0]), np.arctan2(x[:, 2], np.hypot(x[:, 0], x[:, 1]) - 1)
    ring, wave = 1 + SMALL * np.cos(v), np.sin(2 * u)
    exact = np.cos(v) + wave * np.sin(v)
    bend, slope = -np.cos(v) - wave * np.sin(v), -np.sin(v) + wave * np.cos(v)
    source = -(bend / SMALL**2 - np.sin(v) / (SMALL * ring) * slope - 4 * wave * np.sin(v) / ring**2)
    wanted = exact - weights @ exact / forms.area
    found = forms.basis.values(forms.points, poisson(forms, source)[:, None])[:, 0]
    return float(np.sqrt(weights @ (found - wanted) ** 2 / (weights @ wanted**2)))


def _torus_eigenvalues() -> np.ndarray:
    """Of the round torus: u(v) e^{iku} by Fourier series."""
    import scipy.linalg

    n = 255
    ring = 1 + SMALL * np.cos(2 * np.pi * np.arange(n) / n)
    wave = np.fft.fftfreq(n, 1 / n)
    derive = np.real(np.fft.ifft(1j * wave[:, None] * np.fft.fft(np.eye(n), axis=0), axis=0))
    stiff = derive.T @ (ring[:, None] * derive) / SMALL**2
    values = [0.0]
    for k in range(6):
        both = scipy.linalg.eigh(stiff + np.diag(k**2 / ring), np.diag(ring), eigvals_only=True)
        values += list(both[1:8]) if k == 0 else 2 * list(both[:8])
    return np.sort(values)


def distance_meshes(folder: Path | None) -> Iterator[tuple[str, Polyhedron]]:
    """Meshes of about so many vertices: a torus, a plate with two holes, and those of others."""
    yield "torus", torus(140, 72)
    yield "plate", _cut_fine(read(ROOT / "datasets" / "plate_genus2.off"))
    for name in STRANGERS if folder else ():
        yield name.split(".")[0], _cut_fine(read(folder / name))


def _cut_fine(mesh: Polyhedron) -> Polyhedron:
    plain = triangulated(mesh)
    return refine(plain, max(1, round(math.sqrt(2 * VERTICES / plain.face_count)))).polyhedron


def distances(folder: Path | None) -> None:
    """Mean and largest errors, relative to the largest distance, beside the exact ones along the same mesh.

    Of the mesh itself, from which the smooth surface is away by what is said, and of the smooth surface, cut into about
    as many triangles.
    """
    import potpourri3d
    from pygeodesic.geodesic import PyGeodesicAlgorithmExact as Exact

    for name, mesh in distance_meshes(folder):
        surface = fitted(mesh, 1500)
        feet, away = surface.nearest(mesh.vertices)
        source = int(np.argmax(mesh.vertices[:, 0]))
        own = _cut_to(surface, VERTICES)
        ours = geodesic_distance(surface, mesh.vertices[source])
        of_mesh = Exact(mesh.vertices, mesh.triangles).geodesicDistances(np.array([source]))[0]
        print(f"{name}: {len(mesh.vertices)} vertices, at most {away.max() / _size(mesh):.1e} of its size from the fit")
        _compare("front, beside the mesh", ours.at(surface.evaluate(feet)), of_mesh)
        start = int(np.argmin(np.linalg.norm(own.vertices - surface.evaluate(feet)[source], axis=1)))
        of_own = Exact(own.vertices, own.triangles).geodesicDistances(np.array([start]))[0]
        for method in ("front", "heat"):
            begin = time.perf_counter()
            found = geodesic_distance(surface, own.vertices[start], method=method).at(own.vertices)
            _compare(f"{method}, beside the surface", found, of_own, time.perf_counter() - begin)
        begin = time.perf_counter()
        theirs = potpourri3d.MeshHeatMethodDistanceSolver(own.vertices, own.triangles).compute_distance(start)
        _compare("potpourri3d, heat, there", theirs, of_own, time.perf_counter() - begin)


def _cut_to(surface: OrbifoldSurface, vertices: int) -> Polyhedron:
    faces = len(surface.triangulation.own_faces)
    return surface.tessellate(max(1, round(math.sqrt(2 * vertices / faces))), bisected=True)


def _compare(name: str, found: np.ndarray, exact: np.ndarray, seconds: float | None = None) -> None:
    off, most = np.abs(found - exact), exact.max()
    far = exact > 0.1 * most
    spent = "" if seconds is None else f", {seconds:.1f} s"
    print(
        f"  {name:<26} mean {off.mean() / most:.2%}, largest {off.max() / most:.2%} of the farthest; relative, beyond "
        f"a tenth of it: mean {(off[far] / exact[far]).mean():.2%}, largest {(off[far] / exact[far]).max():.2%}{spent}"
    )


def _size(mesh: Polyhedron) -> float:
    return float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))


def _verdict(sound: bool) -> str:
    return "holds" if sound else "DOES NOT HOLD"


def main() -> None:
    """All of it, in some minutes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--meshes", type=Path, metavar="DIR", help="a folder with gc_bob_small.ply and gc_spot.ply")
    folder = parser.parse_args().meshes
    hyperbolic()
    torus_in_space()
    distances(folder)
    fields.main(2000)


if __name__ == "__main__":
    main()
