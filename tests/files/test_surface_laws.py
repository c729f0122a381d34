"""Surface files with other content: the array and the law are named before anything is computed."""

from __future__ import annotations

import io
import json
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fitted import REGISTRY, fitted
from surface_files import Change, changed, with_about, without_sums

from orbiframe.errors import FormatError
from orbiframe.files.surface_file import load_surface, save_surface


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("surface") / "double_torus.npz"
    save_surface(fitted("double torus", 60).surface, path)
    return path


def test_a_file_of_the_first_version_is_read(saved: Path, tmp_path: Path) -> None:
    old, new = load_surface(with_about(saved, tmp_path / "old.npz"), REGISTRY), load_surface(saved, REGISTRY)
    np.testing.assert_array_equal(old.tessellate(2).vertices, new.tessellate(2).vertices)


@pytest.mark.parametrize("name", ["coefficients", "origin", "scale"])
def test_numbers_that_no_law_binds_have_a_check_sum(saved: Path, tmp_path: Path, name: str) -> None:
    with pytest.raises(FormatError, match=rf"the array '{name}' breaks a law: it is what was saved"):
        load_surface(changed(saved, tmp_path / "other.npz", scaled(name, 1 + 1e-12)), REGISTRY)


@pytest.mark.parametrize(
    "entry",
    [{"sha256": {}}, {"weights": "others"}, {"group": "another"}, {"options": {"size": 60, "width": 1.4}}],
)
def test_words_have_a_check_sum_too(saved: Path, tmp_path: Path, entry: dict[str, object]) -> None:
    def change(arrays: dict[str, np.ndarray]) -> None:
        arrays["about"] = np.array(json.dumps({**json.loads(str(arrays["about"])), **entry}))

    with pytest.raises(FormatError, match="the array 'about' breaks a law: it is what was saved"):
        load_surface(changed(saved, tmp_path / "other.npz", change), REGISTRY)


@pytest.mark.parametrize("sums", [None, 3, [], "x"])
def test_sums_that_are_none(saved: Path, tmp_path: Path, sums: object) -> None:
    def change(arrays: dict[str, np.ndarray]) -> None:
        arrays["about"] = np.array(json.dumps({**json.loads(str(arrays["about"])), "sha256": sums}))

    with pytest.raises(FormatError, match="the array 'about' breaks a law: it has a SHA-256 of every array"):
        load_surface(changed(saved, tmp_path / "other.npz", change), REGISTRY)


# ---- arrays ---------------------------------------------------------------------------------------------------------


def put(name: str, place: object, value: object) -> Change:
    def change(arrays: dict[str, np.ndarray]) -> None:
        arrays[name] = arrays[name].copy()
        arrays[name][place] = value

    return change


def cast(name: str, kind: str) -> Change:
    return lambda arrays: arrays.update({name: arrays[name].astype(kind)})


def scaled(name: str, factor: float) -> Change:
    return lambda arrays: arrays.update({name: arrays[name] * factor})


def swapped(name: str) -> Change:
    return lambda arrays: arrays.update({name: arrays[name][::-1].copy()})


def swapped_halves(arrays: dict[str, np.ndarray]) -> None:
    """Two leaves changed for each other."""
    child = arrays["child"] = arrays["child"].copy()
    leaves = np.flatnonzero(arrays["side"] < 0)[:2]
    child[leaves] = child[leaves[::-1]]


def turned_triangles(arrays: dict[str, np.ndarray]) -> None:
    """The coarse mesh with each triangle from another corner on, as sound as before."""
    sides = np.arange(len(arrays["coarse_tail"]))
    after = sides - sides % 3 + (sides + 1) % 3
    before = sides - sides % 3 + (sides + 2) % 3
    arrays["coarse_tail"] = arrays["coarse_tail"][after]
    arrays["coarse_twin"] = before[arrays["coarse_twin"][after]]
    arrays["coarse_same"] = arrays["coarse_same"][after]


# What is changed in a file, the array that is named, and a word of its law; nothing but laws can tell.
BROKEN = {
    "no patch": (lambda a: a.update(atlas_radius=a["atlas_radius"][:0]), "atlas_radius", "positive"),
    "a patch without a vertex": (
        lambda a: a.update(atlas_radius=np.append(a["atlas_radius"], 0.5)),
        "atlas_radius",
        "holds a vertex",
    ),
    "a radius without end": (scaled("atlas_radius", 1e6), "atlas_radius", "reach as far"),
    "a radius too small": (scaled("atlas_radius", 0.5), "atlas_radius", "hold their triangles"),
    "a radius of nan": (put("atlas_radius", 0, np.nan), "atlas_radius", "positive"),
    "a patch too many": (put("patch", 0, 10**6), "patch", "patches are 0 to"),
    "a patch below zero": (put("patch", 3, -1), "patch", "patches are 0 to"),
    "another patch": (put("patch", 0, 7), "transition", "leads from the patch"),
    "a point not in X": (put("points", (5, 0), 3.0), "points", "lie in h2"),
    "a point at infinity": (put("points", (5, 1), np.inf), "points", "finite"),
    "points changed round": (swapped("points"), "atlas_radius", "hold"),
    "a transition too many": (put("transition", 0, 9999), "transition", "transitions are 0 to"),
    "another transition": (put("transition", 0, 5), "transition", "leads"),
    "an isometry of nothing": (put("atlas_isometry", (3, 1, 1), 9.0), "atlas_isometry", "isometries of h2"),
    "another isometry": (swapped("atlas_isometry"), "atlas_isometry", "identity"),
    "an inverse of another": (put("atlas_inverse", 1, 3), "atlas_inverse", "leads back"),
    "no identity": (put("atlas_tail", 0, 0), "atlas_tail", "identity"),
    "a head without patch": (put("atlas_head", 4, 99), "atlas_head", "patches are 0 to"),
    "an area of another surface": (scaled("area", 2.0), "area", "sum of the areas"),
    "a twin of its own": (put("fine_twin", 0, 0), "fine_twin", "pairs"),
    "a twin beyond the end": (put("fine_twin", 0, 10**7), "fine_twin", "halfedges are 0 to"),
    "twins with other ends": (swapped("coarse_twin"), "coarse_twin", "pairs|ends"),
    "a corner beyond the end": (put("coarse_tail", 0, 10**7), "coarse_tail", "vertices are 0 to"),
    "a corner below zero": (put("coarse_tail", 0, -5), "coarse_tail", "vertices are 0 to"),
    "sides turned": (put("fine_same", 0, True), "fine_same", "two twins"),
    "a face of four corners": (put("fine_offsets", 1, 4), "fine_offsets", "three corners"),
    "a vertex at infinity": (put("coarse_vertices", (0, 0), np.inf), "coarse_vertices", "finite"),
    "halves changed round": (swapped_halves, "child", "in common"),
    "another coarse mesh": (turned_triangles, "fine_tail", "halves of coarse ones"),
    "a side that is none": (put("side", 0, 3), "side", "sides are"),
    "a leaf too many": (put("side", 0, -1), "child", "half of one other"),
    "halves of another": (put("child", 0, 7), "child", "half"),
    "a circle in the forest": (put("child", 1, 0), "child", "halves come after"),
    "coefficients of nan": (put("coefficients", (0, 0), np.nan), "coefficients", "finite"),
    "no scale": (scaled("scale", 0.0), "scale", "positive"),
    "a scale below zero": (scaled("scale", -1.0), "scale", "positive"),
    "a scale without end": (scaled("scale", np.inf), "scale", "finite"),
    "an origin of nan": (put("origin", 1, np.nan), "origin", "finite"),
    "whole numbers as fractions": (cast("fine_twin", "f8"), "fine_twin", "int64, not float64"),
    "few digits": (cast("points", "f4"), "points", "float64, not float32"),
    "truth as numbers": (cast("fine_same", "i8"), "fine_same", "bool"),
    "one axis too few": (lambda a: a.update(points=a["points"].ravel()), "points", "2 axes"),
    "one column too many": (lambda a: a.update(points=np.zeros((len(a["points"]), 4))), "points", "3 is required"),
    "one row too few": (lambda a: a.update(points=a["points"][1:]), "points", "is required, as in"),
    "a further array": (lambda a: a.update(extra=np.zeros(3)), "extra", "no such array"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_every_law_is_named_with_its_array(saved: Path, tmp_path: Path, name: str) -> None:
    change, array, law = BROKEN[name]

    def all_changes(arrays: dict[str, np.ndarray]) -> None:
        change(arrays)
        without_sums(arrays)

    with pytest.raises(FormatError, match=rf"bad\.npz: the array '{array}' breaks a law: .*({law})"):
        load_surface(changed(saved, tmp_path / "bad.npz", all_changes), REGISTRY)


def test_bytes_in_the_other_order_are_turned(saved: Path, tmp_path: Path) -> None:
    def change(arrays: dict[str, np.ndarray]) -> None:
        for name in ("fine_twin", "points", "coefficients", "atlas_isometry"):
            arrays[name] = arrays[name].astype(arrays[name].dtype.newbyteorder())

    turned, plain = (
        load_surface(changed(saved, tmp_path / "turned.npz", change), REGISTRY),
        load_surface(saved, REGISTRY),
    )
    np.testing.assert_array_equal(turned.tessellate(2).vertices, plain.tessellate(2).vertices)
    assert turned.triangulation.polyhedron.twin.dtype.isnative


# ---- words ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ({"geometry": "s2"}, "made of h2"),
        ({"geometry": "e2"}, "made of h2"),
        ({"euler_characteristic": 2, "geometry": "s2"}, "Euler characteristic 2"),
        ({"euler_characteristic": -4}, "Euler characteristic -4"),
        ({"orientable": False}, "orientable False"),
        ({"orientable": 1}, "'orientable' in the array 'about' is no bool"),
        ({"euler_characteristic": -2.0}, "is no int"),
        ({"euler_characteristic": True}, "is no int"),
        ({"options": [1]}, "is no dict"),
        ({"basis": ["gaussian"]}, "is no str"),
    ],
)
def test_words_that_do_not_fit_the_arrays(saved: Path, tmp_path: Path, entries: dict[str, object], said: str) -> None:
    with pytest.raises(FormatError, match=said):
        load_surface(with_about(saved, tmp_path / "s.npz", **entries), REGISTRY)


@pytest.mark.parametrize(
    "text",
    [
        '{"kind": "a", "kind": "b"}',
        "[" * 15_000,
        '{"kind": NaN}',
        "1" * 5000,
        '{"version": 1}',
        "null",
        "",
        "9" * 10**6,
    ],
)
def test_about_that_is_no_description(saved: Path, tmp_path: Path, text: str) -> None:
    def change(arrays: dict[str, np.ndarray]) -> None:
        arrays["about"] = np.array(text)

    with pytest.raises(FormatError, match=r"s\.npz"):
        load_surface(changed(saved, tmp_path / "s.npz", change), REGISTRY)


# ---- bytes ----------------------------------------------------------------------------------------------------------


def header(shape: tuple[int, ...], kind: str = "<f8") -> bytes:
    file = io.BytesIO()
    np.lib.format.write_array_header_1_0(file, {"descr": kind, "fortran_order": False, "shape": shape})
    return file.getvalue()


def replaced(path: Path, target: Path, name: str, content: bytes, kind: int = zipfile.ZIP_DEFLATED) -> Path:
    """A copy of an archive with other bytes for one member."""
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as new:
        for entry in old.namelist():
            new.writestr(entry, content if entry == name else old.read(entry), kind if entry == name else None)
    return target


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (header((10**12, 3)), "take .* bytes"),
        (header((10**30, 3)), "take .* bytes"),
        (header((2, 3)), "is required"),
        (header((3198, 3)) + bytes(1000), "long as its header|is required"),
        (header((3198, 3)) + bytes(3198 * 24 + 2**20), "long as its header"),
        (header((3198, 3), "|O"), "neither numbers nor a text"),
        (header((3198, 3), "<c16"), "neither numbers nor a text"),
        (header((-1, 3)), "negative length"),
        (b"\x93NUMPY\x07\x00", "version"),
        (b"", "not a whole surface file"),
    ],
)
def test_what_a_member_says_is_checked_before_memory_is_taken(
    saved: Path, tmp_path: Path, content: bytes, said: str
) -> None:
    with pytest.raises(FormatError, match=said):
        load_surface(replaced(saved, tmp_path / "s.npz", "points.npy", content), REGISTRY)


def test_packed_zeros_take_no_memory(saved: Path, tmp_path: Path) -> None:
    """A hundred megabytes of zeros in a file of a few hundred kilobytes are refused by their count."""
    content = header((5_000_000, 3)) + bytes(120_000_000)
    path = replaced(saved, tmp_path / "s.npz", "points.npy", content)
    assert path.stat().st_size < 10**6
    tracemalloc.start()
    with pytest.raises(FormatError, match=r"its arrays take 12\d+ bytes, and a file of its size holds at most"):
        load_surface(path, REGISTRY)
    assert tracemalloc.get_traced_memory()[1] < 10**7
    tracemalloc.stop()


def test_other_ways_of_packing_are_refused(saved: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(saved) as archive:
        content = archive.read("points.npy")
    for kind in (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        with pytest.raises(FormatError, match="packed in a way"):
            load_surface(replaced(saved, tmp_path / "s.npz", "points.npy", content, kind), REGISTRY)
