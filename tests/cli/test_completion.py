"""Shells complete commands, options, kinds and files."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest

pytest.importorskip("shtab")


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (["orbiframe", "inf"], ["info"]),
        (["orbiframe", "fit", "--tol"], ["--tolerance"]),
        (["orbiframe", "plugins", "--kind", "bas"], ["basis"]),
        (["orbiframe", "new", "pl"], ["plugin"]),
        (["orbiframe", "group", "--geom"], []),
    ],
)
def test_bash_completes(orbiframe, tmp_path, words, wanted):
    ran = orbiframe("completion", "bash")
    assert ran.status == 0
    (tmp_path / "complete.sh").write_text(ran.out)
    script = (
        f"source {tmp_path / 'complete.sh'}; COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; "
        f"_shtab_orbiframe orbiframe '{words[-1]}' '{words[-2]}'; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    )
    found = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True)
    assert [line.strip() for line in found.stdout.splitlines() if line.strip()] == wanted


def test_the_package_that_it_needs_is_named(orbiframe, monkeypatch):
    monkeypatch.setitem(sys.modules, "shtab", None)
    ran = orbiframe("completion", "zsh")
    assert ran.status == 1
    assert 'pip install "orbiframe[completion]"' in ran.err


def test_other_shells_are_refused(orbiframe):
    assert orbiframe("completion", "cmd").status == 2
