"""The laws of a format of elements: a file holds the curved triangles, and nothing of the place of its making."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from orbiframe.surfaces.curved_triangles import LARGEST_ORDER, CurvedMesh
from orbiframe.testing.lab import Lab

Component = Callable[[Path, CurvedMesh], Any]


def file_appears(component: Component, lab: Lab) -> None:
    """Triangles of every order, on surfaces that are orientable or not, become a file of the name asked for."""
    for path, _ in _files(component, lab):
        assert path.is_file(), f"no file {path.name} is made"
        assert path.stat().st_size > 0, f"{path.name} is empty"


def same_bytes(component: Component, lab: Lab) -> None:
    """The same elements written twice, under another name in another folder, give the same bytes."""
    for path, mesh in _files(component, lab):
        folder = lab.tmp_path / "elsewhere"
        folder.mkdir(exist_ok=True)
        other = folder / f"another{lab.suffix or ''}"
        component(other, mesh)
        assert other.read_bytes() == path.read_bytes(), f"the bytes of {path.name} depend on more than the elements"


def mesh_is_unchanged(component: Component, lab: Lab) -> None:
    """Writing changes nothing in the elements."""
    for path, mesh in _meshes(lab):
        nodes, elements = mesh.nodes.copy(), mesh.elements.copy()
        component(path, mesh)
        assert np.array_equal(mesh.nodes, nodes), f"writing {path.name} moved nodes"
        assert np.array_equal(mesh.elements, elements), f"writing {path.name} changed elements"


def every_digit_matters(component: Component, lab: Lab) -> None:
    """Elements of which one node differs in its last digit, or two triangles change places, give different files."""
    path, mesh = next(_meshes(lab))
    moved = mesh.nodes.copy()
    moved[-1, 2] = np.nextafter(moved[-1, 2], np.inf)
    swapped = mesh.elements[[1, 0, *range(2, len(mesh.elements))]]
    files = []
    for one in (mesh, replace(mesh, nodes=moved), replace(mesh, elements=swapped)):
        component(path, one)
        files.append(path.read_bytes())
    assert len(set(files)) == len(files), "different elements give the same bytes"


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    file_appears,
    same_bytes,
    mesh_is_unchanged,
    every_digit_matters,
)


def _meshes(lab: Lab) -> Iterator[tuple[Path, CurvedMesh]]:
    for order in range(1, LARGEST_ORDER + 1):
        for name in ("tetrahedron", "Klein bottle"):
            path = lab.tmp_path / f"{name.replace(' ', '-')}-{order}{lab.suffix or ''}"
            yield path, lab.curved_mesh(name, order)


def _files(component: Component, lab: Lab) -> Iterator[tuple[Path, CurvedMesh]]:
    for path, mesh in _meshes(lab):
        component(path, mesh)
        yield path, mesh


# ---- mutants: each breaks one law ---------------------------------------------------------------------------------


def _forgets_some(component: Component) -> Component:
    def forgetful(path: Path, mesh: CurvedMesh) -> None:
        if mesh.order < LARGEST_ORDER:
            component(path, mesh)

    return forgetful


def _signs_with_its_place(component: Component) -> Component:
    def signed(path: Path, mesh: CurvedMesh) -> None:
        component(path, mesh)
        path.write_bytes(path.read_bytes() + str(path).encode())

    return signed


def _scales_in_place(component: Component) -> Component:
    def scaled(path: Path, mesh: CurvedMesh) -> None:
        component(path, mesh)
        mesh.nodes.__imul__(1.5)

    return scaled


def _rounds(component: Component) -> Component:
    return lambda path, mesh: component(path, replace(mesh, nodes=mesh.nodes.round(6)))


MUTANTS: Mapping[str, Callable[[Component], Component]] = {
    "file_appears": _forgets_some,
    "same_bytes": _signs_with_its_place,
    "mesh_is_unchanged": _scales_in_place,
    "every_digit_matters": _rounds,
}
