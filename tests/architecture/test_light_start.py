"""What every command waits for: the start loads no numerical library, and no component that is not asked for."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

# Of the standard library too: it was 160. What they cost in seconds, `benchmarks/start.py` measures.
MOST_MODULES = 200
HEAVY = {"numpy", "scipy", "numba", "meshio", "open3d", "pydantic", "matplotlib", "pyvista", "vtk"}

PROBE = """
import json, sys
before = set(sys.modules)
from orbiframe.cli.main import main
status = main({arguments!r})
print(json.dumps([status, sorted(set(sys.modules) - before)]), file=sys.stderr)
"""


def loaded_by(*arguments: str) -> tuple[int, set[str]]:
    code = PROBE.format(arguments=list(arguments))
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    status, modules = json.loads(run.stderr.splitlines()[-1])
    return status, set(modules)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["--version"],
        [],
        ["plugins"],
        ["plugins", "--json"],
        ["plugins", "--kind", "basis"],
        *([command, "--help"] for command in ("fit", "info", "convert", "plugins", "warm-up")),
    ],
    ids=" ".join,
)
def test_the_start_is_light(arguments):
    status, modules = loaded_by(*arguments)
    assert status == 0
    assert HEAVY & {name.partition(".")[0] for name in modules} == set()
    assert len(modules) <= MOST_MODULES


def test_the_probe_sees_a_heavy_command():
    _, modules = loaded_by("plugins", "--options", "--kind", "basis")
    assert "numpy" in modules
    assert len(modules) > MOST_MODULES
