"""orbiframe field: a function in closed form from values on a torus, on a fine mesh and at its vertices."""

from __future__ import annotations

import json
from pathlib import Path

import meshio
import numpy as np
import pytest
from fitted import DATASETS, REGISTRY, config

from orbiframe import fit, save_surface


def heat(x: np.ndarray) -> np.ndarray:
    return np.sin(3 * x[:, 0]) + x[:, 2]


@pytest.fixture(scope="module")
def surface(tmp_path_factory) -> Path:
    """A torus, fitted and saved once."""
    path = tmp_path_factory.mktemp("surface") / "torus.npz"
    save_surface(fit(DATASETS / "torus.off", config(800, "basis.name=ps6"), REGISTRY).surface, path)
    return path


def vertices() -> np.ndarray:
    rows = (DATASETS / "torus.off").read_text().split("\n")
    return np.array([row.split() for row in rows[2 : 2 + int(rows[1].split()[0])]], dtype=float)


def csv(path: Path, places: np.ndarray, *columns: np.ndarray) -> Path:
    names = ["x", "y", "z", *("abc"[k] for k in range(len(columns)))]
    rows = np.column_stack([places, *columns]).tolist()
    path.write_text("\n".join([",".join(names), *(",".join(map(repr, row)) for row in rows)]))
    return path


def test_values_at_the_vertices_become_a_function_everywhere(orbiframe, surface, tmp_path) -> None:
    x = vertices()
    data = csv(tmp_path / "data.csv", x, heat(x), np.full(len(x), 7.0))
    ran = orbiframe("field", surface, data, "-o", tmp_path / "out.vtu", "--json")
    assert ran.status == 0, ran.err
    fine = meshio.read(tmp_path / "out.vtu")
    assert len(fine.points) > 15_000
    error = np.abs(fine.point_data["a"] - heat(fine.points))
    assert np.sqrt(np.mean(error**2)) < 2e-3
    assert error.max() < 2e-2
    np.testing.assert_allclose(fine.point_data["b"], 7, atol=1e-9)
    told = json.loads(ran.out)
    assert [each["name"] for each in told["values"]] == ["a", "b"]
    assert told["values"][0]["error"] < 0.02
    assert told["points"] == 288


def test_noise_is_smoothed_and_told(orbiframe, surface, tmp_path) -> None:
    x, noise = vertices(), 0.1
    values = heat(x) + noise * np.random.default_rng(0).normal(size=len(x))
    data = csv(tmp_path / "data.csv", x, values)
    ran = orbiframe("field", surface, data, "-o", tmp_path / "out.csv", "--refine", 0, "--json")
    assert ran.status == 0, ran.err
    found = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)
    np.testing.assert_allclose(found["x"], x[:, 0], atol=1e-12)
    assert np.sqrt(np.mean((found["a"] - heat(x)) ** 2)) < 0.75 * noise
    told = json.loads(ran.out)
    assert 0.8 * noise < told["values"][0]["error"] < 1.5 * noise
    assert 10 < told["freedom"][0] < 200
    ran = orbiframe("field", surface, data, "-o", tmp_path / "met.csv", "--refine", 0, "--fairing", 1e-8)
    met = np.genfromtxt(tmp_path / "met.csv", delimiter=",", names=True)
    assert np.abs(met["a"] - values).max() < 1e-3
    assert "at a point left out" in ran.out


@pytest.mark.long
def test_data_of_two_surfaces_go_to_the_nearer_one(orbiframe, tmp_path) -> None:
    x = vertices()
    text = (DATASETS / "torus.off").read_text().split("\n")
    faces = [list(map(int, row.split()[1:])) for row in text[2 + len(x) :] if row]
    both = np.concatenate([x, x + np.array([0, 0, 3])])
    lines = [" ".join(map(str, [len(f), *f])) for f in [*faces, *([k + len(x) for k in f] for f in faces)]]
    rows = [" ".join(map(repr, row)) for row in both.tolist()]
    (tmp_path / "two.off").write_text("\n".join(["OFF", f"{len(rows)} {len(lines)} 0", *rows, *lines, ""]))
    data = csv(tmp_path / "data.csv", both, heat(both))
    few = ("--set", "basis.size=600")
    ran = orbiframe("field", tmp_path / "two.off", data, "-o", tmp_path / "out.ply", "--refine", 2, *few)
    assert ran.status == 0, ran.err
    fine = meshio.read(tmp_path / "out.ply")
    assert np.sqrt(np.mean((fine.point_data["a"] - heat(fine.points)) ** 2)) < 1e-2
    one = csv(tmp_path / "one.csv", x, heat(x))
    ran = orbiframe("field", tmp_path / "two.off", one, "-o", tmp_path / "out.ply", *few)
    assert (ran.status, "has no datum" in ran.err) == (1, True)


def test_wrong_use_is_said_before_the_work(orbiframe, cube, tmp_path) -> None:
    data = csv(tmp_path / "data.csv", np.eye(3), np.ones(3))
    assert orbiframe("field", cube, data, "-o", tmp_path / "out.stl").status == 1
    assert orbiframe("field", cube, data, "-o", data).status == 2
    assert orbiframe("field", cube, data, "-o", tmp_path / "out.csv", "--refine", -1).status == 2
    ran = orbiframe("field", cube, data, "-o", tmp_path / "out.csv", "--value", "d")
    assert (ran.status, "no values 'd', but a" in ran.err) == (2, True)
    assert not (tmp_path / "out.csv").exists()
