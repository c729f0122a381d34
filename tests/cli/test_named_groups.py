from __future__ import annotations

import json
from pathlib import Path

import pytest

DATASETS = Path(__file__).parents[2] / "datasets"
NAMES = sorted(path.stem for path in DATASETS.glob("*.off"))


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_every_dataset_is_fitted_on_the_regular_polygon(orbiframe, tmp_path, name):
    mesh, report = DATASETS / f"{name}.off", tmp_path / "report.json"
    ran = orbiframe(
        *("fit", mesh, "-o", tmp_path / "smooth.ply", "--group", "regular-polygon"),
        *("--size", 60, "--refine", 1, "--report", report, "--quiet"),
    )
    assert (ran.status, ran.err) == (0, "")
    found = json.loads(report.read_text())
    assert found["group"]["source"].startswith("regular-polygon, word a")
    assert found["group"]["relation_defect"] < 1e-12
    assert found["map"]["not_positive"] == 0
    assert found["map"]["area_defect"] < 1e-9
    assert {"marking", "group", "map"} <= set(found["seconds"])


def test_a_torus_takes_the_lattice_that_is_named(orbiframe, tmp_path):
    """The torus of radii 1 and r = 0.4 is conformal to a rectangle with sides in the ratio of sqrt(1 - r^2) to r."""
    ratio = (1 - 0.4**2) ** 0.5 / 0.4
    medians = []
    for vectors in ([], ["--set", f"group.second=[0, {ratio}]"]):
        ran = orbiframe(
            *("fit", DATASETS / "torus.off", "-o", tmp_path / "smooth.ply", "--group", "lattice", *vectors),
            *("--map", "equivariant", "--size", 60, "--refine", 1, "--json"),
        )
        assert (ran.status, ran.err) == (0, "")
        found = json.loads(ran.out)
        assert found["group"]["source"].startswith("lattice, word ab")
        medians.append(found["map"]["angle_distortion"]["median"])
    assert medians == pytest.approx([ratio, 1], rel=0.05)


@pytest.mark.parametrize(
    ("name", "options", "status", "said"),
    [
        ("plate_genus2", ["--group", "lattice"], 1, "a lattice takes a word with four sides"),
        ("plate_genus2", ["--group", "regular-polygon", "--map", "harmonic"], 1, "group.method = 'mesh'"),
        ("plate_genus2", ["--map", "equivariant"], 1, "needs a named group"),
        ("plate_genus2", ["--map", "sphere"], 1, "does not live on h2"),
        ("plate_genus2", ["--group", "regular"], 2, "installed: finite, lattice, regular-polygon"),
        ("plate_genus2", ["--map", "harmnic"], 2, "Did you mean 'harmonic'?"),
        ("torus", ["--group", "lattice", "--set", "group.first=[0, 1]"], 1, "two independent vectors"),
        ("torus", ["--group", "lattice", "--set", "marking.base=1"], 2, "allowed: method, bases"),
    ],
)
def test_what_does_not_fit_is_refused(orbiframe, tmp_path, name, options, status, said):
    ran = orbiframe("fit", DATASETS / f"{name}.off", "-o", tmp_path / "smooth.ply", *options)
    assert (ran.status, said in ran.err) == (status, True), ran.err
    assert not (tmp_path / "smooth.ply").exists()
