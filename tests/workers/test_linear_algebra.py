"""Linear algebra has one thread while a fit lasts, and its own number before and after it."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

SCRIPT = """
import json, os
import numpy, scipy.linalg
from threadpoolctl import threadpool_info
from orbiframe import fit

def counts():
    return [pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"]

inside = []
before = counts()
fit("dataset:plate_genus2_coarse", size=20, fast=True, progress=lambda stage, seconds: inside.append(counts()))
print(json.dumps([before, inside, counts()]))
"""


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="one processor has one thread")
@pytest.mark.parametrize("chosen", [{}, {"OMP_NUM_THREADS": "2"}])
def test_a_fit_has_one_thread_unless_the_environment_says_otherwise(chosen):
    clean = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")} | chosen
    run = subprocess.run([sys.executable, "-c", SCRIPT], env=clean, capture_output=True, text=True, check=True)
    before, inside, after = json.loads(run.stdout)
    assert len(before) > 0
    assert min(before) > 1
    assert after == before
    assert len(inside) > 4
    assert all(count == ([1] * len(before) if not chosen else before) for count in inside)
