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


def test_error_bars_stand_beside_the_values(orbiframe, surface, tmp_path) -> None:
    """In the data's own unit, on the fine mesh and at the vertices; about 95 % of the truth lies within two of them."""
    x = vertices()
    rng = np.random.default_rng(0)
    first, second = (heat(x) + 0.1 * rng.normal(size=len(x)) for _ in range(2))
    data = csv(tmp_path / "data.csv", x, first, 1000 * second)
    ran = orbiframe("field", surface, data, "-o", tmp_path / "out.vtu", "--error-bars", "--json")
    assert ran.status == 0, ran.err
    fine = meshio.read(tmp_path / "out.vtu").point_data
    places = meshio.read(tmp_path / "out.vtu").points
    assert set(fine) == {"normal", "a", "b", "a_error", "b_error"}
    held = np.abs(fine["a"] - heat(places)) < 1.96 * fine["a_error"]
    assert 0.85 < held.mean() < 1
    assert fine["b_error"].mean() > 100 * fine["a_error"].mean()
    assert json.loads(ran.out)["values"][0]["noise"] == pytest.approx(0.1, rel=0.3)
    assert orbiframe("field", surface, data, "-o", tmp_path / "out.csv", "--error-bars", "--refine", 0).status == 0
    assert (tmp_path / "out.csv").read_text().split("\n")[0] == "vertex,x,y,z,a,b,a_error,b_error"


def test_outliers_are_named_and_data_can_be_met(orbiframe, surface, tmp_path) -> None:
    x = vertices()
    values = heat(x) + 0.05 * np.random.default_rng(0).normal(size=len(x))
    values[[30, 200]] += 4
    data = csv(tmp_path / "data.csv", x, values)
    ran = orbiframe("field", surface, data, "-o", tmp_path / "out.csv", "--robust", "huber", "--json", "--refine", 0)
    assert ran.status == 0, ran.err
    assert {30, 200} <= set(json.loads(ran.out)["outliers"]) <= {*json.loads(ran.out)["outliers"][:6], 30, 200}
    found = np.loadtxt(tmp_path / "out.csv", delimiter=",", skiprows=1)[:, 4]
    assert np.abs(found - heat(x)).max() < 0.3
    said = orbiframe("field", surface, data, "-o", tmp_path / "out.csv", "--robust", "tukey", "--refine", 0).out
    assert "30" in said.split("outliers")[1].split("\n")[0]
    ran = orbiframe("field", surface, data, "-o", tmp_path / "out.csv", "--interpolate", "--refine", 0, "--json")
    met = np.loadtxt(tmp_path / "out.csv", delimiter=",", skiprows=1)[:, 4]
    # The vertices are a little beside the surface, and so are their feet from one call to the next.
    np.testing.assert_allclose(met, values, atol=1e-4)
    assert json.loads(ran.out)["outliers"] is None
    ran = orbiframe("field", surface, data, "-o", tmp_path / "out.csv", "--interpolate", "--fairing", 1)
    assert ran.status == 2
    assert "leave out --fairing" in ran.err


def test_a_column_marks_what_is_met(orbiframe, surface, tmp_path) -> None:
    x = vertices()
    values = heat(x) + 0.2 * np.random.default_rng(0).normal(size=len(x))
    fixed = np.arange(len(x)) < 4
    rows = np.column_stack([x, values, fixed])
    np.savetxt(tmp_path / "data.csv", rows, delimiter=",", header="x,y,z,a,fixed", comments="")
    ran = orbiframe("field", surface, tmp_path / "data.csv", "-o", tmp_path / "out.csv", "--refine", 0)
    assert ran.status == 0, ran.err
    missed = np.abs(np.loadtxt(tmp_path / "out.csv", delimiter=",", skiprows=1)[:, 4] - values)
    assert missed[:4].max() < 1e-4
    assert np.median(missed[4:]) > 0.05


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
