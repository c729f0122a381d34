"""Standard streams that are closed, full or of few letters: what was asked for is made, and no error is internal."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import lines_said

from orbiframe.cli.speech import say
from orbiframe.components.shown_text import shown

ORBIFRAME = [sys.executable, "-c", "import sys; from orbiframe.cli.main import main; sys.exit(main())"]
FIT = ["--size", "30", "--refine", "1"]


def run(arguments: list[object], *, shell: str = "", **environment: str) -> subprocess.CompletedProcess[str]:
    command = [*ORBIFRAME, *map(str, arguments)]
    if shell:
        command = ["sh", "-c", f'exec "$@" {shell}', "sh", *command]
    return subprocess.run(
        command, capture_output=True, text=True, errors="replace", check=False, env={**os.environ, **environment}
    )


@pytest.mark.parametrize(
    ("shell", "status", "said"),
    [
        (">/dev/full", 1, "the standard output cannot be written: No space left on device"),
        ("2>/dev/full", 0, ""),
        (">/dev/full 2>/dev/full", 1, ""),
        (">&-", 0, ""),
        ("2>&-", 0, ""),
        ("<&- >&- 2>&-", 0, ""),
        ("2>/dev/full | true", 0, ""),
    ],
)
def test_streams_that_take_nothing_cost_no_result(cube: Path, tmp_path: Path, shell: str, status: int, said: str):
    out, report, save = tmp_path / "s.ply", tmp_path / "r.json", tmp_path / "s.npz"
    arguments = ["fit", cube, "-o", out, "--report", report, "--save", save, "--orient", "--json", *FIT]
    ran = run(arguments, shell=shell)
    assert ran.returncode == status
    assert said in ran.stderr
    assert "internal" not in ran.stderr
    assert "Exception ignored" not in ran.stderr
    assert out.stat().st_size > 500
    assert save.stat().st_size > 1000
    assert json.loads(report.read_text())["fit"]["size"] == 30


@pytest.mark.parametrize(
    "environment", [{"PYTHONIOENCODING": "ascii"}, {"LC_ALL": "C"}, {"PYTHONIOENCODING": "latin-1:strict"}]
)
def test_letters_that_a_stream_has_not_are_escaped(cube: Path, tmp_path: Path, environment: dict[str, str]):
    named = tmp_path / "würfel ∂ 立方体.off"
    cube.rename(named)
    ran = run(["fit", named, "-o", tmp_path / "s.ply", *FIT], **environment)
    assert (ran.returncode, lines_said(ran.stderr)) == (0, [])
    assert "angles off by" in ran.stdout
    for arguments in (["info", named], ["info", named, named], ["info", tmp_path / "∂.off"]):
        ran = run(arguments, **environment)
        assert "internal" not in ran.stderr


def test_names_of_undecodable_bytes_are_shown(cube: Path, tmp_path: Path):
    named = os.fsencode(tmp_path) + b"/\xff\xfe.off"
    os.rename(cube, named)
    ran = run(["info", os.fsdecode(named), os.fsdecode(named)])
    assert ran.returncode == 0
    assert "genus 0" in ran.stdout
    assert r"\udcff\udcfe.off" in ran.stdout


def test_a_closed_output_cannot_take_a_mesh(cube: Path):
    ran = run(["convert", cube, "-", "-o", "ply"], shell=">&-")
    assert ran.returncode == 1
    assert "the standard output is closed" in ran.stderr


def test_a_full_output_is_said(cube: Path):
    ran = run(["convert", cube, "-", "-o", "ply"], shell=">/dev/full")
    assert ran.returncode == 1
    assert len(lines_said(ran.stderr)) == 1
    assert "the standard output cannot be written" in ran.stderr


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("plain", "plain"),
        ("ä ∂ 立", "ä ∂ 立"),
        ("\x1b[31mred\x07", r"\x1b[31mred\x07"),
        ("one\ntwo\r\tthree\x00", r"one\ntwo\r\tthree\x00"),
        ("abc\u202edef", r"abc\u202edef"),
        ("\udcff", r"\udcff"),
        ("\x9b31m\u2028", r"\x9b31m\u2028"),
    ],
)
def test_what_a_terminal_would_obey_is_escaped(text: str, expected: str):
    assert shown(text) == expected


def test_an_endless_text_is_cut_in_the_middle():
    text = shown("begin " + "x" * 10**6 + " end")
    assert len(text) < 2100
    assert text.startswith("begin x")
    assert text.endswith("x end")
    assert "characters" in text


def test_words_from_a_file_do_not_reach_the_terminal_as_they_are(orbiframe, tmp_path: Path):
    for name, content in {
        "a.off": "OFF\n1 1 1\n\x1b]0;title\x07\n",
        "b.obj": "v 0 0 0\nf \x1b[2J 1 1\n",
        "c.ply": "ply\nformat \x1b[31m 1.0\n",
        "d.off": "OFF\n1 1 1\n" + "y" * 10**5 + "\n",
        "e\x1b[31m.off": "OFF\n",
    }.items():
        path = tmp_path / name
        path.write_text(content)
        for arguments in (["info", path], ["info", path, path], ["convert", path, tmp_path / "out.obj"]):
            ran = orbiframe(*arguments)
            assert ran.status == 1
            assert "\x1b" not in ran.out + ran.err
            assert "\x07" not in ran.out + ran.err
            assert len(ran.out + ran.err) < 6000
            assert "internal" not in ran.err


def test_say_says_nothing_to_nobody(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    say("hello")
