from __future__ import annotations

import os
import sys

import numpy as np
import pytest

from orbiframe.components.registry import Registry
from orbiframe.errors import FormatError, PluginError, UsageError
from orbiframe.files import gate, sandbox, soundness
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.plugin import Component

REGISTRY = Registry.discover()
TETRAHEDRON = Polyhedron.from_faces(
    [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]
)


class Shelf:
    """A registry of functions."""

    def __init__(self, **functions) -> None:
        self.functions = functions

    def components(self, kind):
        return [Component(kind, name, "a:b", "-", suffixes=(".any", f".{name}")) for name in sorted(self.functions)]

    def for_suffix(self, kind, suffix):
        return [c for c in self.components(kind) if suffix in c.suffixes]

    def component(self, kind, name):
        return next(c for c in self.components(kind) if c.name == name)

    def load(self, kind, name):
        return self.functions[name]


def shelf_of(result):
    return Shelf(one=lambda path: result)


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "mesh.one"
    path.write_bytes(b"something")
    return path


@pytest.mark.parametrize("suffix", [".off", ".OBJ", ".ply", ".stl"])
def test_what_is_written_is_read(tmp_path, suffix):
    path = tmp_path / f"mesh{suffix}"
    gate.write(path, TETRAHEDRON, REGISTRY)
    found = gate.read(path, REGISTRY)
    assert np.array_equal(found.vertices[found.tail], TETRAHEDRON.vertices[TETRAHEDRON.tail])
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_a_format_by_name_goes_before_the_suffix(tmp_path):
    gate.write(tmp_path / "mesh.txt", TETRAHEDRON, REGISTRY, format="off")
    assert (tmp_path / "mesh.txt").read_bytes().startswith(b"OFF\n")
    assert gate.read(tmp_path / "mesh.txt", REGISTRY, format="off").face_count == 4
    with pytest.raises(UsageError, match="Did you mean 'off'"):
        gate.read(tmp_path / "mesh.txt", REGISTRY, format="offf")


def test_unknown_suffixes_are_named_with_the_known_ones(tmp_path):
    path = tmp_path / "mesh.plyy"
    path.write_bytes(b"ply")
    with pytest.raises(FormatError, match=r"mesh\.plyy.*'\.plyy'.*\.off.*Did you mean '\.ply'"):
        gate.read(path, REGISTRY)
    with pytest.raises(FormatError, match="no suffix"):
        gate.write(tmp_path / "mesh", TETRAHEDRON, REGISTRY)


def test_two_components_for_a_suffix_are_an_error_that_names_both(tmp_path):
    path = tmp_path / "mesh.any"
    path.write_bytes(b"something")
    with pytest.raises(PluginError, match="one, two"):
        gate.read(path, Shelf(one=lambda p: TETRAHEDRON, two=lambda p: TETRAHEDRON))


def test_every_suffix_belongs_to_one_component():
    for kind in ("reader", "writer"):
        suffixes = [suffix for component in REGISTRY.components(kind) for suffix in component.suffixes]
        assert len(suffixes) == len(set(suffixes))


# ---- before ---------------------------------------------------------------------------------------------------------


def never(path):
    raise AssertionError("the reader was called")


def test_only_regular_files_reach_a_reader(tmp_path):
    (tmp_path / "folder.one").mkdir()
    os.mkfifo(tmp_path / "pipe.one")
    (tmp_path / "zero.one").symlink_to("/dev/zero")
    (tmp_path / "loop.one").symlink_to(tmp_path / "loop.one")
    (tmp_path / "empty.one").touch()
    kinds = {"folder": "folder", "pipe": "pipe", "zero": "device", "loop": "reached", "empty": "empty"}
    for name, kind in kinds.items():
        with pytest.raises(FormatError, match=rf"{name}\.one.*{kind}"):
            gate.read(tmp_path / f"{name}.one", Shelf(one=never))


def test_a_missing_file_is_named_with_its_nearest_neighbour(path):
    with pytest.raises(FormatError, match=r"mash\.one.*no such file.*Did you mean 'mesh\.one'"):
        gate.read(path.with_name("mash.one"), Shelf(one=never))
    with pytest.raises(FormatError):
        gate.read(path.with_name("a\0b.one"), Shelf(one=never))


def test_the_size_limit_holds(path):
    with pytest.raises(FormatError, match=r"9 bytes.*limit of 8"):
        gate.read(path, Shelf(one=never), size_limit=8)
    assert gate.read(path, shelf_of(TETRAHEDRON), size_limit=9) is TETRAHEDRON


# ---- after ----------------------------------------------------------------------------------------------------------


def raising(error):
    def reader(path):
        raise error

    return Shelf(one=reader)


@pytest.mark.parametrize(
    "error", [ValueError("no"), SystemExit(1), MemoryError(), RecursionError(), OSError("no"), KeyError("points")]
)
def test_whatever_a_reader_raises_becomes_a_format_error(path, error):
    with pytest.raises(FormatError, match=r"mesh\.one") as raised:
        gate.read(path, raising(error))
    assert "KeyError" not in str(raised.value)


@pytest.mark.parametrize("kind", [FormatError, ValueError])
def test_words_from_a_file_are_shown_escaped(path, kind):
    def reader(given):
        raise kind(f"{given}: found \x7f\x1b[31m\u202e")

    with pytest.raises(FormatError) as raised:
        gate.read(path, Shelf(one=reader))
    assert str(raised.value).startswith(f"{path}: ")
    assert str(raised.value).endswith(r"found \x7f\x1b[31m\u202e")


def test_an_interrupt_is_no_bad_file(path):
    with pytest.raises(KeyboardInterrupt):
        gate.read(path, raising(KeyboardInterrupt()))


def unsound():
    points = np.eye(3)
    raw = {name: getattr(TETRAHEDRON, name) for name in ("vertices", "offsets", "tail", "twin", "same")}
    return {
        "nothing": (None, "NoneType"),
        "no face": (Polyhedron.from_faces(points, []), "no face"),
        "nan": (Polyhedron.from_faces(points * [1, np.nan, 1], [[0, 1, 2]]), r"vertex 0 is \(1, nan, 0\)"),
        "inf": (Polyhedron.from_faces(np.diag([1, np.inf, 1.0]), [[0, 1, 2]]), "vertex 1"),
        "two corners": (Polyhedron.from_faces(points, [[0, 1, 2], [0, 1]]), "face 1 has the vertices 0 1,"),
        "two vertices": (Polyhedron.from_faces(points, [[0, 1, 2], [0, 1, 0, 1]]), "face 1 has the vertices 0 1 0 1"),
        "no corners": (Polyhedron.from_faces(points, [[0, 1, 2], []]), "face 1"),
        "index": (Polyhedron(**{**raw, "tail": raw["tail"] + 1}), "names vertex 4"),
        "negative index": (Polyhedron(**{**raw, "tail": raw["tail"] - 1}), "names vertex -1"),
        "offsets": (Polyhedron(**{**raw, "offsets": raw["offsets"][:-1]}), "do not fit"),
        "plane": (Polyhedron(**{**raw, "vertices": raw["vertices"][:, :2]}), "vertex table"),
        "normals": (Polyhedron(**raw, normals=np.ones((3, 3))), "normal table"),
        "colours": (Polyhedron(**raw, colors=np.full((4, 3), np.nan)), "colour 0"),
        "face colours": (Polyhedron(**raw, face_colors=np.ones((4, 2))), "face colour table"),
    }


@pytest.mark.parametrize("name", unsound())
def test_no_unsound_polyhedron_passes_in_either_direction(path, name):
    polyhedron, complaint = unsound()[name]
    with pytest.raises(FormatError, match=f"mesh.one.*{complaint}"):
        gate.read(path, shelf_of(polyhedron))
    with pytest.raises(FormatError, match=f"mesh.one.*{complaint}"):
        gate.write(path, polyhedron, Shelf(one=never))
    assert path.read_bytes() == b"something"


def test_distinct_vertices_by_brute_force():
    rng = np.random.default_rng(5)
    faces = [rng.integers(0, 6, n).tolist() for n in rng.integers(1, 9, 200)]
    found = soundness.distinct_vertices(Polyhedron.from_faces(np.zeros((6, 3)), faces))
    assert found.tolist() == [len(set(face)) for face in faces]


# ---- writing --------------------------------------------------------------------------------------------------------


def half(path, polyhedron):
    path.write_bytes(b"half")
    raise ValueError("the disc is full")


def test_nothing_half_written_is_left(path):
    for writer in (half, lambda p, polyhedron: None, lambda p, polyhedron: p.touch()):
        with pytest.raises(FormatError, match=r"mesh\.one"):
            gate.write(path, TETRAHEDRON, Shelf(one=writer))
        assert path.read_bytes() == b"something"
        assert [p.name for p in path.parent.iterdir()] == [path.name]


def test_files_that_belong_together_are_moved_together(path):
    def writer(p, polyhedron):
        p.write_bytes(b"mesh")
        p.with_suffix(".bin").write_bytes(b"points")

    gate.write(path, TETRAHEDRON, Shelf(one=writer))
    assert {p.name: p.read_bytes() for p in path.parent.iterdir()} == {"mesh.one": b"mesh", "mesh.bin": b"points"}


def test_a_link_is_followed_and_kept(path):
    link = path.with_name("link.one")
    link.symlink_to(path)
    gate.write(link, TETRAHEDRON, Shelf(one=lambda p, polyhedron: p.write_bytes(b"new") and None))
    assert link.is_symlink()
    assert path.read_bytes() == b"new"


def test_only_files_in_a_folder_are_written(path, tmp_path):
    os.mkfifo(tmp_path / "pipe.one")
    with pytest.raises(FormatError, match="pipe"):
        gate.write(tmp_path / "pipe.one", TETRAHEDRON, Shelf(one=half))
    with pytest.raises(FormatError, match="no folder"):
        gate.write(tmp_path / "none" / "mesh.one", TETRAHEDRON, Shelf(one=half))
    with pytest.raises(FormatError, match="a folder"):
        gate.write(tmp_path, TETRAHEDRON, Shelf(one=half))


def test_errors_name_the_file_and_not_where_it_was_made(path):
    def refusing(p, polyhedron):
        raise FormatError(f"{p}: no")

    with pytest.raises(FormatError) as caught:
        gate.write(path, TETRAHEDRON, Shelf(one=refusing))
    assert str(caught.value) == f"{path}: no"


# ---- confinement ----------------------------------------------------------------------------------------------------

CULPRITS = """
import os, sys, time
from orbiframe import FormatError, PluginError, Polyhedron

def good(path): return Polyhedron.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0.1]], [[0, 1, 2]])
def crash(path): os.abort()
def hang(path): time.sleep(60)
def leave(path): sys.exit(0)
def eat(path): return bytearray(2**45)
def fail(path): raise KeyError("points")
def refuse(path): raise FormatError(f"{path}, line 7: bad")
def lack(path): raise PluginError("install it")
"""


@pytest.fixture
def confined(tmp_path, monkeypatch):
    (tmp_path / "culprits.py").write_text(CULPRITS)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    return lambda name, **limits: sandbox.confined_read(f"culprits:{name}", tmp_path / "mesh.x", **limits)


def test_a_confined_reader_returns_its_polyhedron(confined):
    found = confined("good")
    assert found.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0.1]]
    assert found.tail.tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("crash", "SIGABRT"),
        ("leave", "ended its process"),
        ("eat", "memory"),
        ("fail", "cannot make sense of the file; is it damaged[?]$"),
        ("refuse", "line 7: bad$"),
    ],
)
@pytest.mark.skipif(sys.platform == "win32", reason="signals and limits of memory are those of Unix")
def test_a_confined_reader_cannot_take_the_process_with_it(confined, name, complaint):
    with pytest.raises(FormatError, match=rf"mesh\.x.*{complaint}"):
        confined(name)


def test_a_confined_reader_has_a_time_limit(confined):
    with pytest.raises(FormatError, match=r"mesh\.x.*more than 0\.5 seconds"):
        confined("hang", seconds=0.5)


def test_a_missing_package_is_no_bad_file(confined):
    with pytest.raises(PluginError, match="install it"):
        confined("lack")
