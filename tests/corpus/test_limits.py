"""Bad files cost little time and memory, and no path in a file is followed."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import tracemalloc
import warnings
import zipfile

import pytest
from corpus import bad_files, obj_files, ply_text_files
from orbiframe_polygons.threemf_reader import MODEL, RELATIONS
from orbiframe_polygons.threemf_writer import RELATION

from orbiframe import FormatError
from orbiframe.components.registry import Registry
from orbiframe.files import gate

REGISTRY = Registry.discover()
SECRET = "secret-place"


def attempt(path) -> None:
    with warnings.catch_warnings(), contextlib.suppress(FormatError):
        warnings.simplefilter("ignore")
        gate.read(path, REGISTRY)


def calls_of(path) -> int:
    """How many functions begin and end, of Python and of C, while a file is read."""
    count = 0

    def one_more(frame, event, argument) -> None:
        nonlocal count
        count += 1

    before = sys.getprofile()
    sys.setprofile(one_more)
    try:
        attempt(path)
    finally:
        sys.setprofile(before)
    return count


@pytest.mark.parametrize("maker", bad_files.MAKERS, ids=lambda maker: maker.__name__)
def test_every_file_of_the_corpus_takes_few_calls_and_100_megabytes(tmp_path, maker):
    """Whatever the numbers in it say. What files cost in seconds, `benchmarks/hostile_files.py` measures."""
    files = [(case, tmp_path / case.name) for case in bad_files.cases_of(maker)]
    for case, path in files:
        path.write_bytes(case.content)
        attempt(path)  # loads what is loaded once
        assert calls_of(path) <= 50_000 + 10 * len(case.content), case.name
    tracemalloc.start()
    try:
        for case, path in files:
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            attempt(path)
            assert tracemalloc.get_traced_memory()[1] - before < 100e6, case.name
    finally:
        tracemalloc.stop()


READ = """
import sys, warnings
from pathlib import Path
from orbiframe import FormatError
from orbiframe.files import gate
from orbiframe.components.registry import Registry

def listen(event, arguments):
    if event in ("open", "os.listdir", "os.scandir", "socket.connect") and "secret-place" in repr(arguments):
        print("opened", event, arguments)
sys.addaudithook(listen)
if len(sys.argv) > 2:
    import importlib
    function = getattr(importlib.import_module("orbiframe_meshio.cells"), "polyhedron_of")
else:
    registry = Registry.discover()
    function = lambda path: gate.read(path, registry)
try:
    function(Path(sys.argv[1]))
    print("read")
except FormatError:
    print("refused")
"""


def outcome(path, *more: str) -> str:
    """What a process of its own says: opened, read or refused."""
    run = subprocess.run([sys.executable, "-c", READ, str(path), *more], capture_output=True, text=True, check=True)
    return run.stdout.strip()


def xdmf(form: str, text: str) -> str:
    return (
        '<Xdmf Version="3.0"><Domain><Grid><Geometry GeometryType="XYZ">'
        f'<DataItem Format="{form}" Dimensions="3 3">{text}</DataItem></Geometry></Grid></Domain></Xdmf>'
    )


def entity(place: str) -> str:
    return f'<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b SYSTEM "file://{place}">]><VTKFile>&b;</VTKFile>'


NAMING = {
    "material.obj": (lambda p: f"mtllib {p}\nusemtl a\nmap_Kd {p}\n", "refused"),
    "library.obj": (lambda p: f"mtllib {p}\n" + obj_files.OBJ, "read"),
    "comment.ply": (lambda p: ply_text_files.PLY.replace("made by hand", f"TextureFile {p}"), "read"),
    "hdf.xdmf": (lambda p: xdmf("HDF", f"{p}:/points"), "refused"),
    "binary.xdmf": (lambda p: xdmf("Binary", str(p)), "refused"),
    "include.xdmf": (
        lambda p: f'<Xdmf xmlns:xi="http://www.w3.org/2001/XInclude"><xi:include href="{p}"/></Xdmf>',
        "refused",
    ),
    "entity.xdmf": (entity, "refused"),
}


@pytest.mark.parametrize("name", NAMING)
def test_a_path_in_a_file_is_not_followed(tmp_path, name):
    (tmp_path / SECRET).write_text(obj_files.OBJ)
    content, expected = NAMING[name]
    (tmp_path / name).write_text(content(tmp_path / SECRET))
    assert outcome(tmp_path / name) == expected


@pytest.mark.parametrize("name", ["entity.vtu", "include.inp", "link.med", "link.cgns"])
def test_meshio_follows_no_path(tmp_path, name):
    secret = tmp_path / SECRET
    secret.write_text("*NODE\n1, 0, 0, 0\n")
    content = {"entity": entity(secret), "include": f"*INCLUDE, INPUT={secret}\n", "link": str(secret)}
    (tmp_path / name).write_text(content[name.split(".")[0]])
    assert outcome(tmp_path / name, "meshio") == "refused"


def test_a_model_in_another_part_is_not_opened(tmp_path):
    path = tmp_path / "a.3mf"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(RELATIONS, RELATION.replace(MODEL, f"../../{SECRET}"))
    (tmp_path / SECRET).write_text("<model/>")
    assert outcome(path) == "refused"


def test_the_listener_hears(tmp_path):
    path = tmp_path / f"{SECRET}.obj"
    path.write_text(obj_files.OBJ)
    assert outcome(path).startswith("opened")
