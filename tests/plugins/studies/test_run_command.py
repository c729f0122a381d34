"""orbiframe run: the folder remembers what is done, and the table is the same however it came about."""

from __future__ import annotations

import json
import math
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from orbiframe_studies import one_fit
from orbiframe_studies.results import Results
from studies import lines, written

from orbiframe.files import file_lock

SIZES = "[sweep]\nbasis.size = [10, 12, 14]\n"


def test_a_study_is_done_once_and_goes_on_with_what_is_new(orbiframe, tmp_path, monkeypatch):
    study, folder = written(tmp_path, SIZES), tmp_path / "quick"
    ran = orbiframe("run", study, "--workers", 1, "--json")
    assert (ran.status, ran.err) == (0, "")
    said = json.loads(ran.out)
    assert (said["fits"], said["done"], said["new"], said["maps"], said["failed"]) == (3, 3, 3, 1, 0)
    assert said["peak"] > 10_000_000
    table = lines(folder / "table.jsonl")
    assert [row["report"]["fit"]["size"] for row in table] == [10, 12, 14]
    assert [row["parameters"] for row in table] == [{"basis.size": size} for size in (10, 12, 14)]
    assert {row["mesh"] for row in table} == {"cube.off"}
    timing = lines(folder / "timings.jsonl")[0]
    assert timing["seconds"]["fit"] > 0
    assert timing["versions"]["orbiframe"]
    # What is done is done: with another size one fit is missing, and it has the map of the others.
    study.write_text(study.read_text().replace("14]", "14, 16]"))
    said = json.loads(orbiframe("run", study, "--workers", 1, "--json").out)
    assert (said["fits"], said["new"], said["maps"]) == (4, 1, 0)
    assert lines(folder / "table.jsonl")[:3] == table
    monkeypatch.setattr(one_fit, "_fitted", None)
    assert json.loads(orbiframe("run", study, "--workers", 1, "--json").out)["new"] == 0


def test_a_fit_that_fails_is_written_down_and_stops_no_other(orbiframe, tmp_path):
    study = written(tmp_path, "")
    (tmp_path / "bad.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    study.write_text(study.read_text().replace('["cube.off"]', '["bad.off", "cube.off"]') + "[basis]\nsize = 10\n")
    ran = orbiframe("run", study, "--workers", 1)
    assert ran.status == 1
    assert "2: 1 done, 1 failed" in ran.out
    failed, done = lines(tmp_path / "quick" / "table.jsonl")
    assert (failed["status"], failed["report"], done["status"]) == ("failed", None, "done")
    assert failed["error"]["type"] == "TopologyError"
    assert "boundary" in failed["error"]["text"] or "closed" in failed["error"]["text"]
    assert json.loads(orbiframe("run", study, "--workers", 1, "--json").out)["new"] == 0
    assert json.loads(orbiframe("run", study, "--workers", 1, "--json", "--retry").out)["new"] == 1


def test_too_little_memory_is_tried_again(orbiframe, tmp_path, monkeypatch):
    def fitted(*_):
        raise MemoryError

    study = written(tmp_path, "[basis]\nsize = 10\n")
    with monkeypatch.context() as patched:
        patched.setattr(one_fit, "_fitted", fitted)
        ran = orbiframe("run", study, "--workers", 1)
    assert (ran.status, "1 lost, to be tried again" in ran.out) == (1, True)
    assert lines(tmp_path / "quick" / "table.jsonl")[0]["error"]["type"] == "MemoryError"
    assert json.loads(orbiframe("run", study, "--workers", 1, "--json").out)["done"] == 1


@pytest.mark.parametrize(("text", "kept"), [("auto", False), ("kept", True)])
def test_maps_of_meshes_with_one_fit_are_kept_if_that_is_asked_for(orbiframe, tmp_path, text, kept):
    study = written(tmp_path, "[basis]\nsize = 10\n")
    study.write_text(study.read_text().replace('["cube.off"]', f'["cube.off"]\nmaps = "{text}"'))
    assert json.loads(orbiframe("run", study, "--workers", 1, "--json").out)["maps"] == 1
    assert (tmp_path / "quick" / "maps").exists() is kept


def test_noise_moves_the_vertices_by_the_seed(orbiframe, tmp_path):
    study = written(tmp_path, "[basis]\nsize = 10\n")
    study.write_text(study.read_text().replace('["cube.off"]', '["cube.off"]\nseeds = [0, 1]\nnoise = 0.001'))
    assert orbiframe("run", study, "--workers", 1).status == 0
    first, second = (row["report"]["fit"]["rms"] for row in lines(tmp_path / "quick" / "table.jsonl"))
    assert first != second
    assert math.isclose(first, second, rel_tol=0.3)


def test_sizes_grow_until_the_error_is_small_enough(orbiframe, tmp_path):
    study = written(tmp_path, "[until]\nstart = 10\nfactor = 2\nmost = 100\nbelow = 0.03\n")
    said = json.loads(orbiframe("run", study, "--workers", 1, "--json").out)
    table = lines(tmp_path / "quick" / "table.jsonl")
    errors = [row["report"]["fit"]["rms"] for row in table]
    assert [row["parameters"]["basis.size"] for row in table] == [10, 20, 40, 80, 100][: len(table)]
    assert errors[-1] <= 0.03
    assert all(error > 0.03 for error in errors[:-1])
    assert said["fits"] == said["new"] == len(table) > 1


def test_optuna_chooses_the_same_again(orbiframe, tmp_path, monkeypatch):
    text = "[basis]\nsize = 10\n[search]\ntrials = 5\nbatch = 2\nspace = {basis = {width = {low = 1.0, high = 3.0}}}\n"
    study = written(tmp_path, text)

    def fitted(fit, *_):
        error = (fit.tables["basis"]["width"] - 2) ** 2
        return SimpleNamespace(report={"fit": {"rms": error, "size": 10}, "seconds": {}, "versions": {}})

    monkeypatch.setattr(one_fit, "_fitted", fitted)
    tables = []
    for folder in ("one", "two"):
        assert orbiframe("run", study, "--workers", 1, "--into", tmp_path / folder).status == 0
        tables.append((tmp_path / folder / "table.jsonl").read_bytes())
    assert tables[0] == tables[1]
    widths = [row["parameters"]["basis.width"] for row in lines(tmp_path / "one" / "table.jsonl")]
    assert len(set(widths)) == 5
    assert all(1 <= width <= 3 for width in widths)
    assert json.loads(orbiframe("run", study, "--workers", 1, "--into", tmp_path / "one", "--json").out)["new"] == 0


def test_what_is_kept_of_a_fit(orbiframe, tmp_path):
    study = written(tmp_path, "[basis]\nsize = 10\n")
    keep = '["cube.off"]\nkeep = ["arrays", "surface", "mesh"]'
    study.write_text(study.read_text().replace('["cube.off"]', keep))
    assert orbiframe("run", study, "--workers", 1).status == 0
    results = Results.of(study)
    (row,) = results.rows()
    (arrays,) = results.arrays(row["key"])
    assert arrays.coefficients.shape == (10, 3)
    assert len(arrays.triangles) == row["report"]["output"]["faces"]
    from orbiframe import Registry, load_surface, read

    registry = Registry.discover()
    surface = load_surface(results.folder.kept(row["key"], ".npz"), registry)
    assert (surface.coefficients == arrays.coefficients).all()
    assert len(read(results.folder.kept(row["key"], ".ply"), registry).vertices) == len(arrays.vertices)


@pytest.mark.parametrize(
    ("make", "said", "status"),
    [
        (lambda folder: folder.write_text("a file"), "cannot be used", 1),
        (lambda folder: (folder.mkdir(), (folder / "notes.txt").write_text("mine")), "holds other things", 2),
        (
            lambda folder: (
                folder.mkdir(),
                (folder / "study.json").write_text('{"kind": "orbiframe study 1", "name": "other", "file": ""}'),
            ),
            "the folder of the study 'other', not of 'quick'",
            2,
        ),
        (lambda folder: (folder.mkdir(), (folder / "study.json").write_text("{")), "no folder of a study", 2),
    ],
    ids=["file", "stranger", "other study", "broken"],
)
def test_folders_of_others_are_left_alone(orbiframe, tmp_path, make, said, status):
    study, folder = written(tmp_path, SIZES), tmp_path / "quick"
    make(folder)
    before = sorted(str(path) for path in tmp_path.rglob("*") if path.name != "lock")
    ran = orbiframe("run", study, "--workers", 1)
    assert (ran.status, said in ran.err) == (status, True), ran.err
    assert sorted(str(path) for path in tmp_path.rglob("*") if path.name != "lock") == before


def test_one_process_works_in_a_folder(orbiframe, tmp_path):
    study = written(tmp_path, SIZES)
    (tmp_path / "quick").mkdir()
    with file_lock(tmp_path / "quick" / "lock"):
        ran = orbiframe("run", study)
    assert (ran.status, "another `orbiframe run` works in this folder" in ran.err) == (1, True)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--workers", "0"], "--workers 0: give 1 to 1024"),
        (["--set", "basis.siez=3"], "Did you mean 'size'?"),
        (["--set", "sweeep.x=3"], "no table named 'sweeep'"),
        (["--scheduler", "nowhere"], "nowhere"),
    ],
)
def test_wrong_use(orbiframe, tmp_path, arguments, said):
    ran = orbiframe("run", written(tmp_path, SIZES), *arguments)
    assert ran.status in (1, 2)
    assert said in ran.err
    assert "Traceback" not in ran.err


def test_a_plan_does_nothing(orbiframe, tmp_path):
    ran = orbiframe("run", written(tmp_path, SIZES), "--plan")
    assert ran.out.splitlines() == ["study     quick, 3 fits", "meshes    1", "sweep     basis.size = 10, 12, 14"]
    assert not (tmp_path / "quick").exists()


def test_lines_of_json_for_programs(orbiframe, tmp_path):
    ran = orbiframe("run", written(tmp_path, SIZES), "--workers", 1, "--progress", "json", "--quiet")
    assert ran.err == ""  # quiet is quiet
    study = written(tmp_path, "[basis]\nsize = 10\n", "other.toml")
    ran = orbiframe("run", study, "--workers", 1, "--progress", "json")
    events = [json.loads(line) for line in ran.err.splitlines()]
    assert {event["event"] for event in events} == {"work"}
    assert (events[0]["done"], events[-1]["done"], events[-1]["total"], events[-1]["share"]) == (0, 1, 1, 1.0)
    assert "cube.off: fit" in {event["what"] for event in events}


# ---- processes ----------------------------------------------------------------------------------------------------


def started(study: Path, *arguments: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "orbiframe", "run", str(study), *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def entries(folder: Path) -> int:
    path = folder / "journal.jsonl"
    return path.read_bytes().count(b"\n") if path.exists() else 0


def wait_for(process: subprocess.Popen[str], folder: Path, count: int) -> None:
    while process.poll() is None and entries(folder) < count:
        time.sleep(0.02)


@pytest.mark.long
def test_the_table_is_the_same_for_any_number_of_workers_and_after_an_interrupt(orbiframe, tmp_path):
    sizes = ", ".join(str(size) for size in range(10, 22))
    study = written(tmp_path, f"[sweep]\nbasis.size = [{sizes}]\n")
    assert orbiframe("run", study, "--workers", 1, "--into", tmp_path / "alone").status == 0
    process = started(study, "--workers", 2)
    wait_for(process, tmp_path / "quick", 2)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "the same command goes on where this one stopped" in err
    partial = lines(tmp_path / "quick" / "table.jsonl")
    assert 2 <= len(partial) < 12
    said = json.loads(orbiframe("run", study, "--workers", 2, "--json").out)
    assert said["new"] == 12 - len(partial)
    assert (tmp_path / "quick" / "table.jsonl").read_bytes() == (tmp_path / "alone" / "table.jsonl").read_bytes()


@pytest.mark.long
def test_a_study_that_is_killed_again_and_again_ends_with_the_same_table(orbiframe, tmp_path):
    sizes = ", ".join(str(size) for size in range(10, 34))
    study = written(tmp_path, f"[sweep]\nbasis.size = [{sizes}]\n")
    assert orbiframe("run", study, "--workers", 1, "--into", tmp_path / "alone").status == 0
    folder = tmp_path / "quick"
    for kill in range(3):
        process = started(study, "--workers", 1 + kill % 2)
        wait_for(process, folder, entries(folder) + 3)
        process.kill()
        process.communicate()
    assert 3 <= entries(folder) < 24
    assert json.loads(orbiframe("run", study, "--workers", 1, "--json").out)["done"] == 24
    assert (folder / "table.jsonl").read_bytes() == (tmp_path / "alone" / "table.jsonl").read_bytes()


@pytest.mark.long
def test_a_basis_that_kills_its_process_costs_only_its_own_fits(orbiframe, tmp_path):
    (tmp_path / "deadly_basis.py").write_text(
        "import os, signal\n"
        "from orbiframe import Component, hookimpl\n"
        "class Deadly:\n"
        "    def __init__(self, orbifold, triangulation, *, size: int = 10):\n"
        "        os.kill(os.getpid(), signal.SIGKILL)\n"
        "@hookimpl\ndef orbiframe_components():\n"
        '    return [Component("basis", "deadly", "deadly_basis:Deadly", "")]\n'
    )
    study = written(tmp_path, '[basis]\nsize = 10\n[sweep]\nbasis.name = ["deadly", "gaussian", "wendland"]\n')
    study.write_text('plugins = ["deadly_basis.py"]\n' + study.read_text())
    ran = orbiframe("run", study, "--workers", 2)
    assert (ran.status, "2 done, 1 lost" in ran.out) == (1, True), ran.out + ran.err
    assert "by signal 9" in lines(tmp_path / "quick" / "table.jsonl")[0]["error"]["text"]


@pytest.mark.long
def test_memory_is_bounded(orbiframe, tmp_path):
    study = written(tmp_path, "[basis]\nsize = 10\n")
    study.write_text(study.read_text().replace('["cube.off"]', '["cube.off"]\nmemory = 0.08'))
    ran = orbiframe("run", study, "--workers", 1)
    assert (ran.status, "1 lost" in ran.out) == (1, True), ran.out
    assert "memory" in lines(tmp_path / "quick" / "table.jsonl")[0]["error"]["text"]
    study.write_text(study.read_text().replace("memory = 0.08", "memory = 8"))
    assert json.loads(orbiframe("run", study, "--workers", 1, "--json").out)["done"] == 1
