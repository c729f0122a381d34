"""Shares of work, and what stands on the error stream for programs."""

from __future__ import annotations

import io
import json
import sys
import threading

import pytest

from orbiframe.cli import main as program, shares
from orbiframe.cli.progress import Progress
from orbiframe.cli.shares import FitShare, in_words, left

STAGES = ["read", "topology", "triangles", "refinement", "map", "basis", "samples", "fit", "error"]
LAST = ["tessellation", "inspection"]


@pytest.fixture
def clock(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(shares.time, "monotonic", lambda: now[0])

    def wait(seconds):
        now[0] += seconds

    return wait


def shares_of(stages, clock, each=1.0):
    share, found = FitShare(), []
    for stage in stages:
        share.begins(stage)
        clock(each)
        found.append(share.share)
        share.ends(stage)
        found.append(share.share)
    return found


@pytest.mark.parametrize(
    "stages",
    [
        [*STAGES, *LAST],
        [*STAGES[:5], "shape", *STAGES[5:], *LAST],
        [*STAGES, "map", "basis", "samples", "fit", "error", *LAST],
        [f"{stage} {part}/3" for part in (1, 2, 3) for stage in [*STAGES, *LAST]],
        ["what nobody knows", *STAGES],
    ],
    ids=["facets", "shape", "smooth", "parts", "unknown"],
)
def test_shares_grow_from_0_to_nearly_1(stages, clock):
    found = shares_of(stages, clock)
    assert found == sorted(found)
    assert 0 <= found[0] < 0.05
    assert found[-1] <= 1
    if stages[-1].startswith("inspection"):
        assert found[-1] > 0.95


def test_parts_have_equal_shares(clock):
    found = shares_of([f"{stage} {part}/2" for part in (1, 2) for stage in [*STAGES, *LAST]], clock)
    assert found[21] == pytest.approx(0.5, abs=0.01)


def test_the_time_that_is_left(clock):
    assert left(0.25, 10.0) == pytest.approx(30.0)
    assert left(0.001, 10.0) is None
    assert left(0.5, 0.1) is None
    assert in_words(None) == ""
    assert [in_words(s) for s in (20, 89, 150, 7200, 200_000)] == [
        "20 s left",
        "89 s left",
        "2 min left",
        "2 h left",
        "2 d left",
    ]


def events(stream: str):
    return [json.loads(line) for line in stream.splitlines()]


def test_stages_are_lines_of_json(monkeypatch):
    monkeypatch.setattr(sys, "stderr", stream := io.StringIO())
    progress = Progress(mode="json")
    progress("map", None)
    progress("map", 0.5)
    progress.close()
    begins, ends = events(stream.getvalue())
    assert (begins["event"], begins["stage"], begins["state"]) == ("stage", "map", "begins")
    assert (ends["state"], ends["seconds"]) == ("ends", 0.5)
    assert 0 <= begins["share"] < ends["share"] < 1


def test_a_long_stage_is_told_again(monkeypatch):
    from orbiframe.cli import progress as module

    monkeypatch.setattr(module, "_TICK", 0.01)
    monkeypatch.setattr(sys, "stderr", stream := io.StringIO())
    progress = Progress(mode="json")
    progress("fit", None)
    while "alive" not in stream.getvalue():
        module.time.sleep(0.01)
    progress.close()
    alive = events(stream.getvalue())[1]
    assert (alive["event"], alive["stage"]) == ("alive", "fit")


def test_a_command_without_stages_is_alive(monkeypatch):
    from orbiframe.cli import progress as module

    monkeypatch.setattr(module, "_TICK", 0.01)
    monkeypatch.setattr(sys, "stderr", stream := io.StringIO())
    progress = Progress(mode="json")
    progress.watch("group")
    while "alive" not in stream.getvalue():
        module.time.sleep(0.01)
    progress.close()
    assert events(stream.getvalue())[0]["stage"] == "group"
    Progress(stream, mode="auto").watch("group")
    assert events(stream.getvalue())[-1]["event"] == "alive"


def test_nothing_is_told_when_nothing_goes_on(monkeypatch):
    from orbiframe.cli import progress as module

    monkeypatch.setattr(module, "_TICK", 0.01)
    monkeypatch.setattr(sys, "stderr", stream := io.StringIO())
    before = threading.active_count()
    progress = Progress(mode="json")
    progress("fit", None)
    progress("fit", 1.0)
    while threading.active_count() > before:
        module.time.sleep(0.01)
    assert [event["event"] for event in events(stream.getvalue()) if event["event"] != "alive"] == ["stage"] * 2
    assert events(stream.getvalue())[-1]["state"] == "ends"


def test_a_cell_of_a_notebook_is_written_over_like_a_terminal():
    shown = type("OutStream", (io.StringIO,), {"__module__": "ipykernel.iostream"})()
    progress = Progress(shown)
    progress("map", None)
    assert shown.getvalue() == "\rmap …"
    progress("map", 1.0)
    assert shown.getvalue().endswith("1.00 s\n")
    progress.close()


def test_all_that_is_said_is_json_then(orbiframe, cube, tmp_path):
    ran = orbiframe("fit", cube, "-o", tmp_path / "out.nothing", "--progress", "json")
    assert ran.status == 1
    (said,) = events(ran.err)
    assert (said["event"], "suffix" in said["text"]) == ("says", True)
    ran = orbiframe("fit", cube, "-o", tmp_path / "out.nothing", "--progress=json")
    assert events(ran.err) == [said]
    assert not orbiframe("fit", cube, "-o", tmp_path / "out.nothing").err.startswith("{")


def test_a_fit_tells_all_its_stages(orbiframe, cube, tmp_path, monkeypatch):
    monkeypatch.undo()
    arguments = ["fit", str(cube), "-o", str(tmp_path / "out.ply"), "--size", "20", "--refine", "1", "--fast"]
    monkeypatch.setattr(sys, "stderr", stream := io.StringIO())
    assert program.main([*arguments, "--progress", "json"]) == 0
    ended = [event["stage"] for event in events(stream.getvalue()) if event.get("state") == "ends"]
    assert ended[-2:] == LAST
    assert "map" in ended
