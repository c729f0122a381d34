"""orbiframe fit --into: many meshes, each as if it were alone."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from orbiframe import Registry, read

DATASETS = Path(__file__).parents[2] / "datasets"
QUICK = ["--size", "20", "--refine", "1", "--fast"]


@pytest.fixture
def bad(tmp_path) -> Path:
    path = tmp_path / "bad.off"
    path.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    return path


def test_what_can_be_fitted_is_and_the_status_tells_of_the_rest(orbiframe, cube, bad, tmp_path):
    ran = orbiframe("fit", cube, bad, DATASETS / "torus.off", "--into", tmp_path / "new" / "out", *QUICK)
    assert ran.status == 1
    first, second, last = ran.out.splitlines()
    assert first.startswith(f"{tmp_path / 'new' / 'out' / 'cube.ply'}: 20 functions, rms ")
    assert "torus.ply: 20 functions" in second
    assert last.startswith("2 of 3 meshes fitted in ")
    assert ran.err.startswith("orbiframe: ")
    assert str(bad) in ran.err
    assert sorted(path.name for path in (tmp_path / "new" / "out").iterdir()) == ["cube.ply", "torus.ply"]


def test_a_mesh_among_many_gives_the_same_bytes_as_alone(orbiframe, cube, tmp_path):
    alone = tmp_path / "alone.obj"
    assert orbiframe("fit", cube, "-o", alone, *QUICK).status == 0
    ran = orbiframe("fit", cube, "--into", tmp_path / "out", "--to", ".obj", "--json", *QUICK)
    assert ran.status == 0
    (line,) = ran.out.splitlines()
    told = json.loads(line)
    assert (told["mesh"], told["fit"]["size"], told["warnings"]) == (str(cube), 20, [])
    assert Path(told["file"]).read_bytes() == alone.read_bytes()


def test_options_that_name_one_file_are_refused(orbiframe, cube, tmp_path):
    for option in ("-o", "--report", "--save"):
        ran = orbiframe("fit", cube, "--into", tmp_path / "out", option, tmp_path / "x.ply")
        assert (ran.status, "names one file" in ran.err) == (2, True)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["{cube}", "{cube}"], "give one MESH and -o OUT"),
        (["{cube}"], "give one MESH and -o OUT"),
        (["{cube}", "sub/../{cube}", "--into", "{tmp}/out"], "2 of the meshes would become"),
        (["{cube}", "--into", "{tmp}/out", "--workers", "0"], "--workers 0"),
        (["{cube}", "--into", "{tmp}/out", "--set", "basis.siez=3"], "Did you mean 'size'?"),
        (["{cube}", "--into", "{cube}/out"], "cannot be written"),
    ],
)
def test_wrong_use_is_refused_before_any_work(orbiframe, cube, tmp_path, arguments, said):
    ran = orbiframe("fit", *(text.format(cube=cube, tmp=tmp_path) for text in arguments))
    assert ran.status in (1, 2)
    assert said in ran.err
    assert not (tmp_path / "out").exists()


@pytest.mark.long
def test_processes_give_the_same_files(orbiframe, cube, bad, tmp_path):
    meshes = [cube, bad, *(DATASETS / f"{name}.off" for name in ("torus", "plate_genus2_coarse", "sphere"))]
    for workers in (1, 2):
        ran = orbiframe("fit", *meshes, "--into", tmp_path / str(workers), "--workers", workers, *QUICK)
        assert (ran.status, "4 of 5 meshes fitted" in ran.out) == (1, True)
    one, two = ({path.name: path.read_bytes() for path in (tmp_path / n).iterdir()} for n in "12")
    assert one == two
    assert set(read(tmp_path / "2" / "cube.ply", Registry.discover()).vertices.shape) == {3, 8}


@pytest.mark.long
def test_many_meshes_grow_no_memory(orbiframe, cube, tmp_path):
    """In this process, after some fits have filled the caches, thirty more leave next to nothing behind."""
    from orbiframe.workers import resident_memory

    copies = []
    for number in range(30):
        copies.append(tmp_path / f"cube{number}.off")
        copies[-1].write_bytes(cube.read_bytes())
    import os

    orbiframe("fit", *copies, "--into", tmp_path / "out", "--quiet", *QUICK)
    before = resident_memory(os.getpid())
    orbiframe("fit", *copies, "--into", tmp_path / "out", "--quiet", *QUICK)
    assert resident_memory(os.getpid()) - before < 10_000_000
