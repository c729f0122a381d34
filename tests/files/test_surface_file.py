"""Surface files: the same bits when loaded, and any other file named in a sentence."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import hard_surfaces as hard
import numpy as np
import pytest
from fitted import REGISTRY, config, fitted, mesh_of
from surface_files import changed, with_about, without_sums

from orbiframe.errors import FormatError, OrbiframeError, UsageError
from orbiframe.files.surface_file import load_surface, save_surface
from orbiframe.fitting import pipeline
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.surfaces.surface import OrbifoldSurface

NAMES = ["tetrahedron", "projective plane", "Klein bottle", "double torus"]
SIZE = 60


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("surface") / "double_torus.npz"
    save_surface(fitted("double torus", SIZE).surface, path)
    return path


def assert_same_bits(a: OrbifoldSurface, b: OrbifoldSurface) -> None:
    rng = np.random.default_rng(0)
    face = rng.integers(a.refinement.coarse.face_count, size=300)
    barycentric = rng.dirichlet([1, 1, 1], size=300)
    ours, theirs = a.points(face, barycentric), b.points(face, barycentric)
    np.testing.assert_array_equal(ours.x, theirs.x)
    np.testing.assert_array_equal(ours.patch, theirs.patch)
    for left, right in zip(a.jet(ours), b.jet(theirs), strict=True):
        np.testing.assert_array_equal(left, right)
    mine, other = a.tessellate(3), b.tessellate(3)
    for name in ("vertices", "normals", "offsets", "tail", "twin", "same"):
        np.testing.assert_array_equal(getattr(mine, name), getattr(other, name))


@pytest.mark.parametrize("name", NAMES)
def test_a_loaded_surface_evaluates_to_the_same_bits(name: str, tmp_path: Path) -> None:
    surface = fitted(name, SIZE).surface
    save_surface(surface, tmp_path / "s.npz")
    loaded = load_surface(tmp_path / "s.npz", REGISTRY)
    assert_same_bits(surface, loaded)
    assert loaded.total_curvature(2) == surface.total_curvature(2)
    assert (loaded.scale, loaded.basis_name) == (surface.scale, "gaussian")
    assert loaded.basis_options == surface.basis_options
    assert loaded.basis_options["size"] == SIZE
    assert loaded.orbifold.orientable == surface.orbifold.orientable
    assert loaded.orbifold.euler_characteristic == surface.orbifold.euler_characteristic
    assert loaded.triangulation.group == surface.triangulation.group
    assert loaded.triangulation.weights == surface.triangulation.weights


def test_flips_of_needles_are_saved(tmp_path: Path) -> None:
    """A plate with triangles without height; a file that flips other edges than those of two triangles is refused."""
    surface = pipeline.fit(hard.with_slivers(hard.plate(1, 2, 2), 0.2, 0.0, 2), config(SIZE), REGISTRY).surface
    assert len(surface.refinement.log.halfedge) > 100
    save_surface(surface, tmp_path / "s.npz")
    assert_same_bits(surface, load_surface(tmp_path / "s.npz", REGISTRY))

    def refused(change: Callable[[dict[str, np.ndarray]], None], law: str) -> None:
        with pytest.raises(FormatError, match=rf"wild\.npz: the array 'flip_halfedge' breaks a law: {law}"):
            load_surface(changed(tmp_path / "s.npz", tmp_path / "wild.npz", change), REGISTRY)

    refused(lambda arrays: arrays["flip_halfedge"].__iadd__(10**6), "halfedges are 0 to")
    refused(lambda arrays: arrays["flip_halfedge"].__setitem__((5, 1), arrays["flip_halfedge"][5, 0]), "an edge of two")
    refused(lambda arrays: arrays["flip_halfedge"].__setitem__(5, arrays["flip_halfedge"][6]), "the two halfedges are")


def test_halved_edges_of_needles_are_saved(tmp_path: Path) -> None:
    """A fan whose needles are halved on their surface; files that halve others, or elsewhere, are refused."""
    turn = 2 * np.pi * np.arange(300) / 300
    prism = [np.stack([np.cos(turn), np.sin(turn), np.full(300, z)], axis=1) for z in (0.0, 2.0)]
    ring, after = np.arange(300), np.roll(np.arange(300), -1)
    sides = np.stack([ring, after, 300 + after, 300 + ring], axis=1)
    faces = [*sides.tolist(), ring[::-1].tolist(), (300 + ring).tolist()]
    mesh = Polyhedron.from_faces(np.concatenate(prism), faces)
    surface = pipeline.fit(mesh, config(SIZE), REGISTRY).surface
    log = surface.refinement.log
    assert log is not None
    assert log.halved.sum() > 1000
    save_surface(surface, tmp_path / "s.npz")
    assert_same_bits(surface, load_surface(tmp_path / "s.npz", REGISTRY))

    def refused(change: Callable[[dict[str, np.ndarray]], None], law: str) -> None:
        with pytest.raises(FormatError, match=rf"wild\.npz: the array '{law}"):
            load_surface(changed(tmp_path / "s.npz", tmp_path / "wild.npz", change), REGISTRY)

    first = int(np.flatnonzero(log.halved)[0])
    halved, crossing = "flip_halved", "flip_crossing' breaks a law: edges are halved in the middle"
    refused(lambda arrays: arrays[halved].__setitem__(first, False), "flip_halfedge' breaks a law: halfedges are 0 to")
    refused(lambda arrays: arrays.pop(halved), "flip_halfedge' breaks a law: halfedges are 0 to")
    refused(lambda arrays: arrays[halved].__setitem__(slice(None), True), crossing)
    refused(lambda arrays: arrays["flip_crossing"].__setitem__((first, 0), 0.4), crossing)


@pytest.mark.parametrize("unit", [None, "metre"])
def test_the_unit_is_kept(tmp_path: Path, unit: str | None) -> None:
    surface = pipeline.fit(replace(mesh_of("cube"), unit=unit), config(30), REGISTRY).surface
    save_surface(surface, tmp_path / "s.npz")
    assert load_surface(tmp_path / "s.npz", REGISTRY).tessellate(1).unit == unit
    with pytest.raises(FormatError, match="'unit' in the array 'about' is none of millimetre, metre"):
        load_surface(with_about(tmp_path / "s.npz", tmp_path / "wild.npz", unit="cubit"), REGISTRY)


@pytest.mark.parametrize("name", ["sphere.off", "torus.off"])
def test_a_smooth_mesh_whose_vertices_were_moved_is_loaded(name: str, tmp_path: Path) -> None:
    surface = fitted(name, SIZE).surface
    save_surface(surface, tmp_path / "s.npz")
    assert_same_bits(surface, load_surface(tmp_path / "s.npz", REGISTRY))


def test_options_of_the_basis_and_place_in_space_are_kept(tmp_path: Path) -> None:
    mesh = mesh_of("torus")
    moved = mesh.with_vertices(mesh.vertices * 1e-3 + 50)
    surface = pipeline.fit(moved, config(50, "basis.width=2.0", "basis.reach=2.5"), REGISTRY).surface
    save_surface(surface, tmp_path / "s.npz")
    loaded = load_surface(tmp_path / "s.npz", REGISTRY)
    assert_same_bits(surface, loaded)
    assert loaded.basis_options == {"size": 50, "width": 2.0, "reach": 2.5, "grading": 0.3}


def test_saving_twice_gives_the_same_arrays_and_replaces_the_file(saved: Path, tmp_path: Path) -> None:
    target = tmp_path / "s.npz"
    target.write_text("something else")
    save_surface(load_surface(saved, REGISTRY), target)
    with np.load(saved) as first, np.load(target) as second:
        assert first.files == second.files
        for name in first.files:
            np.testing.assert_array_equal(first[name], second[name])
    assert [path.name for path in tmp_path.iterdir()] == ["s.npz"]


def test_nothing_in_the_file_is_pickled(saved: Path) -> None:
    with np.load(saved, allow_pickle=False) as archive:
        assert all(not archive[name].dtype.hasobject for name in archive.files)


# ---- damaged files --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("part", [0.0, 0.001, 0.3, 0.9, 0.999])
def test_a_file_cut_short_is_refused(saved: Path, tmp_path: Path, part: float) -> None:
    whole = saved.read_bytes()
    target = tmp_path / "short.npz"
    target.write_bytes(whole[: int(part * len(whole))])
    with pytest.raises(FormatError, match=r"short\.npz"):
        load_surface(target, REGISTRY)


def test_a_changed_byte_is_found_or_harmless(saved: Path, tmp_path: Path) -> None:
    """Archives hold a check sum of every array; a byte of an unused field of the archive may change nothing."""
    whole, surface = saved.read_bytes(), load_surface(saved, REGISTRY)
    rng = np.random.default_rng(2)
    sentences = []
    for place in [*rng.integers(len(whole), size=40), *rng.integers(len(whole) - 1500, len(whole), size=60)]:
        target = tmp_path / "damaged.npz"
        target.write_bytes(whole[:place] + bytes([whole[place] ^ (1 << int(rng.integers(8)))]) + whole[place + 1 :])
        try:
            loaded = load_surface(target, REGISTRY)
        except FormatError as error:
            sentences.append(str(error))
        else:
            np.testing.assert_array_equal(loaded.coefficients, surface.coefficients)
            np.testing.assert_array_equal(loaded.triangulation.points, surface.triangulation.points)
    assert len(sentences) > 40
    assert all("damaged.npz" in sentence for sentence in sentences)


def pickled() -> bytes:
    file = io.BytesIO()
    np.savez(file, about=np.array([{"kind": "orbiframe surface"}], dtype=object))
    return file.getvalue()


def archive_of(**members: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return file.getvalue()


def other_numpy(save: Callable[[io.BytesIO], None]) -> bytes:
    file = io.BytesIO()
    save(file)
    return file.getvalue()


STRANGERS = {
    "text": b"OFF\n4 4 0\n",
    "noise": np.random.default_rng(0).bytes(5000),
    "one array": other_numpy(lambda file: np.save(file, np.arange(5))),
    "other archive": other_numpy(lambda file: np.savez(file, a=np.arange(5), b=np.eye(3))),
    "about is no JSON": other_numpy(lambda file: np.savez(file, about=np.array("no json"))),
    "about is a list": other_numpy(lambda file: np.savez(file, about=np.array("[1, 2]"))),
    "about is empty": other_numpy(lambda file: np.savez(file, about=np.array("{}"))),
    "pickled": pickled(),
    "zip without arrays": archive_of(readme=b"hello"),
    "empty zip": archive_of(),
    "half a header": b"PK\x03\x04",
}


@pytest.mark.parametrize("name", STRANGERS)
def test_other_files_are_refused_by_name(name: str, tmp_path: Path) -> None:
    path = tmp_path / "other.npz"
    path.write_bytes(STRANGERS[name])
    with pytest.raises(FormatError, match=r"other\.npz.*--save"):
        load_surface(path, REGISTRY)


@pytest.mark.parametrize("version", [0, 3, "1", True, 1.5, None])
def test_another_version_is_named(saved: Path, tmp_path: Path, version: object) -> None:
    with pytest.raises(FormatError, match=f"version {version} of 'orbiframe surface' is not known"):
        load_surface(with_about(saved, tmp_path / "new.npz", version=version), REGISTRY)


def test_a_missing_array_is_named(saved: Path, tmp_path: Path) -> None:
    for name in ("coefficients", "atlas_isometry", "coarse_twin", "scale"):
        path = changed(saved, tmp_path / "part.npz", lambda arrays, name=name: arrays.pop(name))
        with pytest.raises(FormatError, match=rf"part\.npz.*{name}"):
            load_surface(path, REGISTRY)


def test_coefficients_must_fit_the_basis(saved: Path, tmp_path: Path) -> None:
    def change(arrays: dict[str, np.ndarray]) -> None:
        arrays["coefficients"] = arrays["coefficients"][:-1]
        without_sums(arrays)

    with pytest.raises(FormatError, match=f"{SIZE - 1} coefficients .* {SIZE} functions"):
        load_surface(changed(saved, tmp_path / "less.npz", change), REGISTRY)


@pytest.mark.parametrize("entry", [{"basis": "nowhere"}, {"geometry": "q9"}, {"options": {"no_such_option": 3}}])
def test_components_that_are_not_there_are_named(saved: Path, tmp_path: Path, entry: dict[str, object]) -> None:
    with pytest.raises(UsageError, match=r"nowhere|q9|no_such_option"):
        load_surface(with_about(saved, tmp_path / "s.npz", **entry), REGISTRY)


# ---- places ---------------------------------------------------------------------------------------------------------


def test_no_file_and_no_regular_file(tmp_path: Path) -> None:
    for path in (tmp_path / "absent.npz", tmp_path, tmp_path / "absent" / "s.npz"):
        with pytest.raises(FormatError, match=re.escape(path.name)):
            load_surface(path, REGISTRY)


def test_where_it_cannot_be_written_nothing_is_left(saved: Path, tmp_path: Path) -> None:
    surface = load_surface(saved, REGISTRY)
    (tmp_path / "file").write_text("kept")
    (tmp_path / "folder").mkdir()
    long_name = "x" * 300 + ".npz"
    for place in ("absent/s.npz", "file/s.npz", "folder", long_name):
        with pytest.raises(FormatError, match="cannot be written"):
            save_surface(surface, tmp_path / place)
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["file", "folder"]
    assert (tmp_path / "file").read_text() == "kept"


def test_a_full_disc_leaves_the_old_file(saved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    surface = load_surface(saved, REGISTRY)
    target = tmp_path / "s.npz"
    target.write_text("old")

    def full(file, **arrays):
        file.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", full)
    with pytest.raises(OrbiframeError, match=r"s\.npz cannot be written: No space left"):
        save_surface(surface, target)
    assert [path.name for path in tmp_path.iterdir()] == ["s.npz"]
    assert target.read_text() == "old"
