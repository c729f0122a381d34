"""After `orbiframe warm-up` no usual command has to compile anything."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.fresh

ROOT = Path(__file__).parents[2]
MESHES = ["plate_genus2", "torus", "sphere", "klein_bottle", "projective_plane", "dodecahedron"]
BASES = ["ps3", "ps6", "simplex", "dms", "clough-tocher", "argyris", "hybrid", "wendland"]

USUAL = [
    *(f"fit datasets/{name}.off -o out.ply --quiet" for name in MESHES),
    *(f"fit datasets/{name}.off -o out.ply --basis ps2 --size 300 --quiet" for name in MESHES),
    *(f"fit datasets/plate_genus2_coarse.off -o out.ply --basis {basis} --size 200 --quiet" for basis in BASES),
    "fit datasets/torus.off -o out.ply --basis tensor-bspline --quiet",
    "fit datasets/torus.off -o out.obj --basis ps2 --group lattice --quiet",
    "fit datasets/plate_genus2.off -o out.stl --group regular-polygon --quiet",
    "fit datasets/plate_genus2_coarse.off -o out.ply --shape regular-faces --quiet",
    "fit datasets/sphere.off -o out.vtu --basis ps2 --save out.npz --quiet",
    "fit datasets/klein_bottle.off -o out.ply --basis ps2 --tolerance 0.01 --quiet",
    "fit datasets/dodecahedron.off -o out.ply --basis simplex --set basis.degree=3 --quiet",
    "fit datasets/cube.off -o out.ply --weld 0 --drop-degenerate --orient --triangulate --quiet",
    "info datasets/plate_genus3.off --loops out.json",
    "convert datasets/cube.off out.obj",
    "draw datasets/torus.off --surface -o out.svg",
    "draw datasets/plate_genus2_coarse.off --cut -o out.svg",
    "draw out.npz -o out.svg",
    "group abABcdCD --spectrum 4 --systole --draw out.svg",
    "group *237 --spectrum 3",
]

RUN = """
import contextlib, io, json, os, sys
from orbiframe.cli.main import main
from orbiframe.compiled import compilation

class Heard:
    def __init__(self):
        self.names = []
    def begins(self, name):
        self.names.append(name)
    def ends(self):
        pass

compiled = {}
for line in json.load(sys.stdin):
    heard = Heard()
    with compilation.heard(heard), contextlib.redirect_stdout(io.StringIO()):
        assert main(line.split()) == 0, line
    if heard.names:
        compiled[line] = heard.names
print(json.dumps(compiled))
"""


@pytest.fixture(scope="module")
def environment(tmp_path_factory) -> dict[str, str]:
    """Where nothing is kept but what the command has compiled."""
    folder = tmp_path_factory.mktemp("warm_up")
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder)}
    command = [sys.executable, "-m", "orbiframe", "warm-up", "--quiet"]
    run = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")
    return environment


def test_usual_commands_compile_nothing(environment, tmp_path):
    (tmp_path / "datasets").symlink_to(ROOT / "datasets")
    run = subprocess.run(
        [sys.executable, "-c", RUN],
        cwd=tmp_path,
        env=environment,
        input=json.dumps(USUAL),
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert json.loads(run.stdout) == {}
