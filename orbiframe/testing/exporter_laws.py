"""The laws of an exporter: a file holds the surface itself, and nothing of the place and time of its making."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from orbiframe.errors import FitError
from orbiframe.surfaces.surface import OrbifoldSurface
from orbiframe.testing.lab import Lab

Component = Callable[[Path, OrbifoldSurface], Any]

# A surface with an inside, one in the hyperbolic plane, and one that is not orientable.
SAMPLES = ("tetrahedron", "double torus", "Klein bottle")


def file_appears(component: Component, lab: Lab) -> None:
    """Every surface of piecewise polynomials, orientable or not, becomes a file of the name that was asked for."""
    for path, _ in _files(component, lab):
        assert path.is_file(), f"no file {path.name} is made"
        assert path.stat().st_size > 0, f"{path.name} is empty"


def same_bytes(component: Component, lab: Lab) -> None:
    """The same surface written twice, under another name in another folder, gives the same bytes."""
    for path, surface in _files(component, lab):
        folder = lab.tmp_path / "elsewhere"
        folder.mkdir(exist_ok=True)
        other = folder / f"another{lab.suffix or ''}"
        component(other, surface)
        assert other.read_bytes() == path.read_bytes(), f"the bytes of {path.name} depend on more than the surface"


def surface_is_unchanged(component: Component, lab: Lab) -> None:
    """Writing changes nothing in the surface."""
    for name in SAMPLES:
        surface = lab.surfaces[name]
        copies = [table.copy() for table in _tables(surface)]
        component(_path(lab, name), surface)
        for table, copy in zip(_tables(surface), copies, strict=True):
            assert np.array_equal(table, copy), f"writing the {name} changed it"


def shape_and_place_matter(component: Component, lab: Lab) -> None:
    """Surfaces that differ in one coefficient, or lie elsewhere in space, give different files."""
    surface = lab.surfaces[SAMPLES[0]]
    bent = surface.coefficients.copy()
    bent[0, 0] += 0.125
    changed = surface, replace(surface, coefficients=bent), replace(surface, origin=surface.origin + 1.0)
    files = []
    for number, one in enumerate(changed):
        path = _path(lab, f"surface {number}")
        component(path, one)
        files.append(path.read_bytes())
    assert len(set(files)) == len(files), "different surfaces give the same bytes"


def other_functions_are_refused(component: Component, lab: Lab) -> None:
    """A surface of functions that are no piecewise polynomials is a FitError, and no file is left.

    Or the exporter says, as `error` in what it gives back, how far from the surface the file is.
    """
    path = _path(lab, "bumps")
    try:
        told = component(path, lab.surface(SAMPLES[0], "gaussian"))
    except FitError:
        assert not path.exists(), "a file is left"
        return
    near = told.get("error") if isinstance(told, Mapping) else None
    assert isinstance(near, float), "a surface without exact patches is accepted, and no error is told"


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    file_appears,
    same_bytes,
    surface_is_unchanged,
    shape_and_place_matter,
    other_functions_are_refused,
)


def _files(component: Component, lab: Lab) -> Iterator[tuple[Path, OrbifoldSurface]]:
    for name in SAMPLES:
        path = _path(lab, name)
        component(path, lab.surfaces[name])
        yield path, lab.surfaces[name]


def _path(lab: Lab, name: str) -> Path:
    return lab.tmp_path / f"{name.replace(' ', '-')}{lab.suffix or ''}"


def _tables(surface: OrbifoldSurface) -> tuple[Any, ...]:
    mesh = surface.triangulation.polyhedron
    return surface.coefficients, surface.origin, mesh.vertices, mesh.tail, surface.triangulation.points


# ---- mutants: each breaks one law ---------------------------------------------------------------------------------


def _forgets_some(component: Component) -> Component:
    def forgetful(path: Path, surface: OrbifoldSurface) -> None:
        if surface.orbifold.orientable:
            component(path, surface)

    return forgetful


def _signs_with_its_place(component: Component) -> Component:
    def signed(path: Path, surface: OrbifoldSurface) -> None:
        component(path, surface)
        path.write_bytes(path.read_bytes() + str(path).encode())

    return signed


def _scales_in_place(component: Component) -> Component:
    def scaled(path: Path, surface: OrbifoldSurface) -> None:
        component(path, surface)
        surface.coefficients.__imul__(1.5)

    return scaled


def _centres(component: Component) -> Component:
    return lambda path, surface: component(path, replace(surface, origin=np.zeros(3)))


def _writes_anything(component: Component) -> Component:
    def lenient(path: Path, surface: OrbifoldSurface) -> None:
        try:
            component(path, surface)
        except FitError:
            path.write_text("a mesh")

    return lenient


MUTANTS: Mapping[str, Callable[[Component], Component]] = {
    "file_appears": _forgets_some,
    "same_bytes": _signs_with_its_place,
    "surface_is_unchanged": _scales_in_place,
    "shape_and_place_matter": _centres,
    "other_functions_are_refused": _writes_anything,
}
