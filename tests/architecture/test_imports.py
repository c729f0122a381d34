"""Who imports whom: the contracts in pyproject.toml hold, and they notice when they do not."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LINT = [sys.executable, "-c", "from importlinter.cli import lint_imports_command; lint_imports_command()"]

# A line that must not be: (file, line, contract that breaks).
OFFENCES = [
    ("orbiframe/meshes/polyhedron.py", "import orbiframe.surfaces.surface", "The kernel is built in layers"),
    ("orbiframe/meshes/polyhedron.py", "import orbiframe.words.word", "The kernel is built in layers"),
    ("orbiframe/planes/geometry.py", "import orbiframe_geometries.h2", "The kernel knows no plugin"),
    ("plugins/orbiframe_bases/gaussian.py", "import orbiframe_fitters.plugin", "Plugins are strangers"),
    ("plugins/orbiframe_bases/gaussian.py", "import orbiframe.components.registry", "Plugins see facades"),
    ("plugins/orbiframe_bases/gaussian.py", "from orbiframe.planes.geometry import Geometry", "Plugins see facades"),
    ("plugins/orbiframe_bases/gaussian.py", "import orbiframe.errors", "Plugins see facades"),
    ("plugins/orbiframe_bases/plugin.py", "import numpy", "light"),
    ("orbiframe/components/registry.py", "import orbiframe.meshes.polyhedron", "light"),
]


def linted(folder: Path) -> subprocess.CompletedProcess[str]:
    # The copy's own folders come first on the path, before an installed orbiframe.
    command = [*LINT[:2], f"import sys; sys.path[:0] = [{str(folder)!r}, {str(folder / 'plugins')!r}]; {LINT[2]}"]
    return subprocess.run([*command, "--no-cache"], cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture
def copy(tmp_path):
    skipped = shutil.ignore_patterns("__pycache__")
    for name in ("orbiframe", "plugins"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=skipped)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def test_the_contracts_hold():
    run = linted(ROOT)
    assert run.returncode == 0, run.stdout


@pytest.mark.parametrize(("file", "line", "contract"), OFFENCES, ids=[f"{f} {line}" for f, line, _ in OFFENCES])
def test_an_offence_is_noticed(copy, file, line, contract):
    path = copy / file
    path.write_text(path.read_text() + f"\n{line}\n")
    run = linted(copy)
    assert run.returncode == 1
    broken = [text for text in run.stdout.splitlines() if " BROKEN" in text]
    assert any(contract in text for text in broken), run.stdout
