"""What every command waits for: the start loads no numerical library, and no component that is not asked for."""

from __future__ import annotations

import json
import subprocess
import sys
import time

import pytest

HEAVY = {"numpy", "scipy", "numba", "meshio", "open3d", "pydantic", "matplotlib", "pyvista", "vtk"}

PROBE = """
import json, sys
from orbiframe.cli.main import main
status = main({arguments!r})
print(json.dumps([status, sorted({{name.partition(".")[0] for name in sys.modules}})]), file=sys.stderr)
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
    assert HEAVY & modules == set()


def test_the_probe_sees_a_heavy_command():
    _, modules = loaded_by("plugins", "--options", "--kind", "basis")
    assert "numpy" in modules


def test_help_comes_at_once():
    def seconds() -> float:
        start = time.perf_counter()
        subprocess.run([sys.executable, "-m", "orbiframe", "--help"], capture_output=True, check=True)
        return time.perf_counter() - start

    # The least of several runs, as other work on the machine can only add to it.
    assert min(seconds() for _ in range(5)) < 0.3
