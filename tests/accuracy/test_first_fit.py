"""The first fit on a machine: what has to be compiled for it, counted where nothing is kept from before."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.fresh

ROOT = Path(__file__).parents[2]

COUNT = """
import collections, json, sys
from orbiframe.cli.main import main
from numba.core import event

class Counter(event.Listener):
    names = collections.Counter()
    def on_start(self, event):
        self.names[event.data["dispatcher"].py_func.__qualname__] += 1
    def on_end(self, event):
        pass

event.register("numba:compile", Counter())
assert main(["fit", "datasets/plate_genus2.off", "-o", sys.argv[1], "--refine", "1", "--quiet", *sys.argv[2:]]) == 0
print(json.dumps(Counter.names))
"""
# Whatever numba makes for an assignment of an array to a slice or row, for sorts and for texts.
SLOW = ("ol_raise_with_shape_context", "quicksort", "concatenate", "unicode", "eye")


@pytest.mark.parametrize(
    ("options", "most"),
    # Of numba's own functions too. It was 146 and 238 with assignments to slices and a version for every number.
    [(["--size", "50"], 130), (["--basis", "ps2", "--size", "50"], 175)],
    ids=["gaussian", "ps2"],
)
def test_a_first_fit_compiles_little(tmp_path, options, most):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", COUNT, str(tmp_path / "smooth.ply"), *options]
    run = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    compiled = json.loads(run.stdout.splitlines()[-1])
    assert 20 <= sum(compiled.values()) <= most, compiled
    assert [name for name in compiled if any(word in name for word in SLOW)] == []
