"""The examples of gradient descent run where their libraries are installed, and come to the same surface."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest
from documents import ROOT


@pytest.mark.long
@pytest.mark.parametrize("library", ["torch", "jax"])
def test_gradient_descent_comes_near_to_the_points(library):
    pytest.importorskip(library, reason=f"{library} is not installed")
    script = ROOT / "docs" / "examples" / f"gradient_descent_{library}.py"
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False, env=dict(os.environ))
    assert done.returncode == 0, done.stderr
    found = [float(number) for number in re.findall(r"square (\S+)", done.stdout)]
    assert len(found) == 5
    assert found[0] > 0.1
    assert found[-1] < 1.2e-3
