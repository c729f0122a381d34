"""A fit of an installation that nobody can write to, for a user without a home: it runs, with one warning."""

from __future__ import annotations

import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import lines_said

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[2]

RUN = """
import sys
sys.path[:0] = sys.argv[1:3]
from orbiframe.cli.main import main
sys.exit(main(["fit", "datasets/torus.off", "-o", sys.argv[3], "--size", "40", "--refine", "1"]))
"""


@pytest.fixture
def installation(tmp_path):
    """A copy of the program. Root may write anywhere: so a file stands in place of each folder that would be made."""
    for name in ("orbiframe", "plugins"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    for folder in {path.parent for path in tmp_path.rglob("*.py")}:
        (folder / "__pycache__").write_text("")
    (tmp_path / "temporary").mkdir()
    return tmp_path


def fitted(installation: Path, name: str) -> tuple[bytes, list[str]]:
    """What a fit writes, and the lines of its standard error stream."""
    settings = {"HOME": "/dev/null", "TMPDIR": str(installation / "temporary"), "PYTHONDONTWRITEBYTECODE": "1"}
    dropped = {"NUMBA_CACHE_DIR", "XDG_CACHE_HOME"}
    environment = {key: value for key, value in os.environ.items() if key not in dropped} | settings
    places = [str(installation), str(installation / "plugins"), str(installation / name)]
    command = [sys.executable, "-c", RUN, *places]
    run = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return (installation / name).read_bytes(), lines_said(run.stderr)


def test_code_lies_in_a_temporary_folder_of_the_user_alone(installation):
    first, said = fitted(installation, "first.ply")
    assert said[0] == "orbiframe: compiling, once on this machine …"
    assert len([line for line in said if line.startswith("orbiframe: warning: compiled code can be kept")]) == 1
    assert len([line for line in said if "warning" in line]) == 1
    kept = next(path for path in (installation / "temporary").iterdir() if path.name.startswith("orbiframe-"))
    assert stat.S_IMODE(kept.stat().st_mode) == 0o700
    second, said = fitted(installation, "second.ply")
    assert said == []
    assert second == first


def test_without_any_folder_it_runs_all_the_same(installation):
    user = os.getuid() if hasattr(os, "getuid") else "user"
    (installation / "temporary" / f"orbiframe-{user}").write_text("")
    _, said = fitted(installation, "first.ply")
    assert len([line for line in said if "so that every run compiles again" in line]) == 1
    assert len([line for line in said if "warning" in line]) == 1
