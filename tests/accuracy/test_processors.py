"""One input, several processors: OpenBLAS multiplies by kernels of the processor, which round in other orders."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.long

DATASETS = Path(__file__).parents[2] / "datasets"
# Name of the dataset and what is said of the fit; cube, torus and the solids have many vertices that are equally far.
FITS = {
    "cube": ["cube.off"],
    "cube, linear": ["cube.off", "fitter.name=least-squares", "data.lift=false", "data.means=facets"],
    "cube, wendland": ["cube.off", "basis.name=wendland"],
    "dodecahedron": ["dodecahedron.off"],
    "torus": ["torus.off"],
    "torus, steps iterated": ["torus.off", "basis.size=250"],
    "klein bottle": ["klein_bottle.off"],
    "crosscaps": ["three_crosscaps.off"],
    "sphere, splines": ["sphere.off", "basis.name=ps2"],
    "genus 2, named group": ["plate_genus2_coarse.off", "group.method=regular-polygon"],
}
CODE = """
import json, sys
from pathlib import Path
from orbiframe import Config, Registry, fit
registry, found = Registry.discover(), {}
for name, (path, *overrides) in json.loads(sys.argv[2]).items():
    config = Config.load(overrides=["basis.size=120", "output.refine=1", *overrides])
    found[name] = fit(Path(sys.argv[1]) / path, config, registry).report
print(json.dumps(found))
"""


@cache
def reports(kernel: str) -> dict[str, Any]:
    environment = {key: value for key, value in os.environ.items() if key != "OPENBLAS_CORETYPE"}
    named = {"OPENBLAS_CORETYPE": kernel} if kernel else {}
    command = [sys.executable, "-c", CODE, str(DATASETS), json.dumps(FITS)]
    ran = subprocess.run(command, capture_output=True, text=True, check=True, env={**environment, **named})
    return json.loads(ran.stdout)


def entries(report: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every entry of a report but for times and versions."""
    if isinstance(report, list) and any(isinstance(each, dict) for each in report):
        report = dict(enumerate(report))
    if not isinstance(report, dict):
        yield path, report
        return
    for key, value in report.items():
        if key not in ("seconds", "versions"):
            yield from entries(value, f"{path}.{key}")


@pytest.mark.parametrize("name", FITS)
@pytest.mark.parametrize("kernel", ["Prescott", "Haswell", "SkylakeX"])
def test_reports_agree_to_nine_digits(kernel: str, name: str) -> None:
    """Sizes and names to the letter. A library without such kernels ignores the name."""
    ours, theirs = dict(entries(reports("")[name])), dict(entries(reports(kernel)[name]))
    assert ours.keys() == theirs.keys()
    for path, value in ours.items():
        if isinstance(value, (float, list)):
            digits = 1e-7 if path.startswith(".curvature") else 1e-9  # second derivatives have fewer
            assert theirs[path] == pytest.approx(value, rel=digits, abs=digits), path
        else:
            assert theirs[path] == value, path
