"""orbiframe spectrum and distance: a round torus in closed form, two spheres, pictures, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import meshio
import numpy as np
import pytest
from fitted import DATASETS, REGISTRY, config
from orbiframe_fields.number_pictures import level_segments
from round_surfaces import round_torus_eigenvalues, sphere, torus

from orbiframe import Polyhedron, fit, save_surface

SMALL = 0.4


@pytest.fixture(scope="module")
def saved(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("surface") / "torus.npz"
    save_surface(torus(), path)
    return path


def table(path: Path) -> np.ndarray:
    return np.genfromtxt(path, delimiter=",", names=True)


@pytest.mark.long
def test_the_spectrum_of_the_round_torus(orbiframe, saved, tmp_path) -> None:
    out, picture = tmp_path / "out.csv", tmp_path / "out.png"
    ran = orbiframe(
        "spectrum", saved, "--count", 5, "-o", out, "--refine", 0, "--picture", picture, "--heat", 0.5, "--json"
    )
    assert ran.status == 0, ran.err
    told = json.loads(ran.out)
    values, errors = (np.array([each[key] for each in told["spectrum"]]) for key in ("value", "error"))
    exact = round_torus_eigenvalues(SMALL)[:5]
    # The surface is round to 1e-6 only, so that much is forgiven beside the errors that are said.
    assert (np.abs(values - exact) <= errors + 3e-6 * exact + 1e-9).all()
    assert errors.max() < 1e-4
    assert told["area"] == pytest.approx(4 * np.pi**2 * SMALL, rel=1e-4)
    found = table(out)
    # The second and the third are u(v) cos s and u(v) sin s: the sum of squares knows no angle s.
    squares = found["function_1"] ** 2 + found["function_2"] ** 2
    outer = np.abs(np.hypot(found["x"], found["y"]) - 1 - SMALL) < 1e-6
    assert np.ptp(squares[outer]) < 1e-4 * squares.max()
    assert np.ptp(found["heat_05"][outer]) < 1e-4 * found["heat_05"].max()
    assert picture.read_bytes()[:4] == b"\x89PNG"
    text = orbiframe("spectrum", saved, "--count", 5).out.splitlines()
    assert text[3].split()[-1] == f"{errors[1]:.1e}"


@pytest.mark.long
def test_two_spheres_have_both_spectra(orbiframe, tmp_path) -> None:
    """Radii 1 and 2 side by side: 0 twice, then 2 / 4 three times, then 6 / 4 five times, then 2 / 1 three times."""
    one = sphere().own_mesh
    x = one.vertices / np.linalg.norm(one.vertices, axis=1, keepdims=True)
    faces = np.concatenate([one.triangles, one.triangles + len(x)])
    rows = [" ".join(map(repr, row)) for row in np.concatenate([x, 2 * x + [5, 0, 0]]).tolist()]
    lines = [f"3 {a} {b} {c}" for a, b, c in faces.tolist()]
    (tmp_path / "two.off").write_text("\n".join(["OFF", f"{len(rows)} {len(lines)} 0", *rows, *lines, ""]))
    few = "--set", "basis.size=500", "--set", "data.means=smooth"
    ran = orbiframe("spectrum", tmp_path / "two.off", "--count", 13, *few, "-o", tmp_path / "out.vtu", "--json")
    assert ran.status == 0, ran.err
    values = [each["value"] for each in json.loads(ran.out)["spectrum"]]
    np.testing.assert_allclose(values, [0] * 2 + [0.5] * 3 + [1.5] * 5 + [2.0] * 3, rtol=1e-3, atol=1e-8)
    found = meshio.read(tmp_path / "out.vtu")
    second = found.points[:, 0] > 2.5
    assert np.abs(found.point_data["function_2"][~second]).max() == 0
    assert np.abs(found.point_data["function_2"][second]).max() > 0.1
    ran = orbiframe(
        "distance", tmp_path / "two.off", "--from", 0, *few, "-o", tmp_path / "far.csv", "--refine", 0, "--json"
    )
    assert ran.status == 0, ran.err
    far = table(tmp_path / "far.csv")["geodesic"]
    exact = np.arccos(np.clip(x @ x[0], -1, 1))
    assert np.abs(far[: len(x)] - exact).max() < 0.01 * np.pi
    assert np.isinf(far[len(x) :]).all()
    assert json.loads(ran.out)["not_reached"] == len(x)


@pytest.mark.long
def test_distances_on_the_torus(orbiframe, saved, tmp_path) -> None:
    """Round the tube and along the outer and the inner circle ways are arcs, and exact as far as they are shortest."""
    ran = orbiframe("distance", saved, "--from", "1.4,0,0", "-o", tmp_path / "out.csv", "--refine", 0, "--json")
    assert ran.status == 0, ran.err
    found = table(tmp_path / "out.csv")
    flat = (np.abs(found["y"]) < 1e-9) & (found["x"] > 0)
    angle = np.abs(np.arctan2(found["z"], found["x"] - 1))[flat]
    np.testing.assert_allclose(found["geodesic"][flat], SMALL * angle, atol=2e-3)
    heat = orbiframe(
        "distance", saved, "--from", "1.4,0,0", "-o", tmp_path / "h.csv", "--refine", 0, "--method", "heat"
    )
    assert heat.status == 0, heat.err
    assert np.abs(table(tmp_path / "h.csv")["geodesic"] - found["geodesic"]).max() < 0.05 * found["geodesic"].max()
    picture = orbiframe("distance", saved, "--from", 0, "--picture", tmp_path / "out.png")
    assert picture.status == 0, picture.err
    assert (tmp_path / "out.png").stat().st_size > 10_000


def test_level_segments_lie_on_the_level():
    x = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]])
    mesh = Polyhedron.from_faces(x, [[0, 1, 2], [1, 3, 2]])
    values = x[:, 0] + 2 * x[:, 1]
    found = np.array(level_segments(mesh, values, 1.5))
    assert len(found) == 2
    np.testing.assert_allclose(found[..., 0] + 2 * found[..., 1], 1.5, atol=1e-12)
    assert level_segments(mesh, values, 5.0) == []
    assert len(level_segments(mesh, np.where(values == 3, np.inf, values), 1.5)) == 1


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["distance", "--from", "0"], "-o out.vtu"),
        (["distance", "--from", "a,b", "-o", "out.csv"], "a place, such as 0.5,0,1"),
        (["distance", "--from", "1,2,inf", "-o", "out.csv"], "a place, such as 0.5,0,1"),
        (["distance", "--from", "0", "--picture", "out.jpg"], "written as .png"),
        (["spectrum", "--count", "0"], "at least 1"),
        (["spectrum", "--heat", "0", "-o", "out.csv"], "a positive time"),
        (["spectrum", "--heat", "1"], "name their file with -o"),
        (["spectrum", "--width", "1"], "beside --wave"),
        (["spectrum", "--refine", "-1"], "0 for the vertices"),
    ],
)
def test_what_is_wrong_is_said_at_once(orbiframe, cube, tmp_path, monkeypatch, arguments, said) -> None:
    monkeypatch.chdir(tmp_path)
    ran = orbiframe(arguments[0], cube, *arguments[1:])
    assert ran.status == 2, ran.err
    assert said in ran.err
    assert "Traceback" not in ran.err
    assert not list(tmp_path.glob("out.*"))


def test_a_vertex_that_is_not_there(orbiframe, tmp_path) -> None:
    surface = fit(DATASETS / "torus.off", config(100), REGISTRY).surface
    save_surface(surface, tmp_path / "t.npz")
    ran = orbiframe("distance", tmp_path / "t.npz", "--from", 5000, "-o", tmp_path / "out.csv")
    assert ran.status == 2
    assert "the mesh has the vertices 0 to 287" in ran.err
