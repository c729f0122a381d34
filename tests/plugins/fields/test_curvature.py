"""Curvature at vertices: spheres, tori and an ellipsoid in closed form, and what is written."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from fitted import DATASETS, grid

ROUND = 0.4  # of the torus, whose big radius is 1


def torus(along: int, across: int, shift: float = 0.0):
    rng = np.random.default_rng(0)

    def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        u = u + shift * rng.uniform(-1, 1, u.shape) * 2 * np.pi / along
        v = v + shift * rng.uniform(-1, 1, v.shape) * 2 * np.pi / across
        ring = 1 + ROUND * np.cos(v)
        return np.stack([ring * np.cos(u), ring * np.sin(u), ROUND * np.sin(v)], axis=1)

    return grid(along, across, place)


def saved(path: Path, mesh, extra: str = "") -> Path:
    rows = [" ".join(map(repr, row)) for row in mesh.vertices.tolist()]
    faces = [f"{len(c)} {' '.join(map(str, c.tolist()))}" for c in np.split(mesh.tail, mesh.offsets[1:-1])]
    path.write_text("\n".join(["OFF", f"{len(rows)} {len(faces)} 0", *rows, *faces, extra]))
    return path


def table(path: Path) -> np.ndarray:
    return np.genfromtxt(path, delimiter=",", names=True)


def vectors(found: np.ndarray, name: str) -> np.ndarray:
    return np.stack([found[f"{name}_{axis}"] for axis in "xyz"], axis=1)


def errors_on_the_torus(found: np.ndarray) -> tuple[float, float]:
    """The largest errors of the principal and of the Gaussian curvatures, of the largest such curvature."""
    radius = np.hypot(found["x"], found["y"])
    cosine = (radius - 1) / ROUND
    k1, k2 = 1 / ROUND, cosine / radius
    away = np.maximum(np.abs(found["k1"] - k1), np.abs(found["k2"] - k2)).max() / k1
    gaussian = k1 * k2
    return float(away), float(np.abs(found["gaussian"] - gaussian).max() / np.abs(gaussian).max())


@pytest.mark.long
@pytest.mark.parametrize("shift", [0.0, 0.25], ids=["regular", "irregular"])
def test_a_torus_of_1000_vertices_within_one_percent(shift, orbiframe, tmp_path) -> None:
    mesh = saved(tmp_path / "torus.off", torus(40, 25, shift))
    ran = orbiframe("curvature", mesh, "-o", tmp_path / "out.csv", "--json")
    assert ran.status == 0, ran.err
    found = table(tmp_path / "out.csv")
    principal, gaussian = errors_on_the_torus(found)
    assert principal < 0.01
    assert gaussian < 0.01
    meridian = np.stack([-found["z"] * found["x"], -found["z"] * found["y"]], axis=1)
    radius = np.hypot(found["x"], found["y"])
    along = np.column_stack([meridian / (ROUND * radius)[:, None], (radius - 1) / ROUND])
    assert np.abs(np.einsum("ni,ni->n", along, vectors(found, "direction1"))).min() > 0.9999
    assert abs(json.loads(ran.out)["total"]) < 1e-3


def test_a_small_torus_and_its_signs(orbiframe, tmp_path) -> None:
    """Normals point outward, from where a torus bends as a sphere does; inside out the signs change."""
    mesh, few = torus(24, 12), ("--set", "basis.size=600")
    ran = orbiframe("curvature", saved(tmp_path / "torus.off", mesh), "-o", tmp_path / "out.csv", *few)
    assert ran.status == 0, ran.err
    found = table(tmp_path / "out.csv")
    assert max(errors_on_the_torus(found)) < 0.02
    radius = np.hypot(found["x"], found["y"])
    outward = np.stack([found["x"] * (1 - 1 / radius), found["y"] * (1 - 1 / radius), found["z"]], axis=1) / ROUND
    assert np.einsum("ni,ni->n", outward, vectors(found, "normal")).min() > 0.999
    inside_out = type(mesh).from_corners(mesh.vertices, mesh.offsets, mesh.tail[::-1])
    orbiframe("curvature", saved(tmp_path / "torus.off", inside_out), "-o", tmp_path / "back.csv", *few)
    back = table(tmp_path / "back.csv")
    np.testing.assert_allclose(back["k1"], -found["k2"], atol=0.03)
    np.testing.assert_allclose(vectors(back, "normal"), -vectors(found, "normal"), atol=0.02)


@pytest.mark.long
def test_two_surfaces_keep_their_vertices_in_their_order(orbiframe, tmp_path) -> None:
    """Spheres of radius 1 and 2 with vertices that alternate, and one vertex in no face."""
    text = (DATASETS / "sphere.off").read_text().split("\n")
    count = int(text[1].split()[0])
    corners = np.array([line.split() for line in text[2 : 2 + count]], dtype=float)
    faces = np.array([line.split()[1:] for line in text[2 + count :] if line], dtype=int)
    corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    both = np.stack([corners, 2 * corners + [5, 0, 0]], axis=1).reshape(-1, 3)
    rows = [" ".join(map(repr, row)) for row in [*both.tolist(), [9.0, 9.0, 9.0]]]
    lines = [f"3 {a} {b} {c}" for a, b, c in np.concatenate([2 * faces, 2 * faces + 1]).tolist()]
    (tmp_path / "two.off").write_text("\n".join(["OFF", f"{len(rows)} {len(lines)} 0", *rows, *lines, ""]))
    ran = orbiframe("curvature", tmp_path / "two.off", "-o", tmp_path / "out.csv", "--json")
    assert ran.status == 0, ran.err
    found = table(tmp_path / "out.csv")
    np.testing.assert_allclose(found["k1"][0:-1:2], 1, rtol=0.01)
    np.testing.assert_allclose(found["k2"][1:-1:2], 0.5, rtol=0.01)
    assert np.isnan(found["k1"][-1])
    assert json.loads(ran.out)["total"] == pytest.approx(8 * np.pi, rel=1e-3)


@pytest.mark.long
def test_a_surface_without_an_outside_and_edges_that_are_sharp(orbiframe, tmp_path) -> None:
    ran = orbiframe("curvature", DATASETS / "klein_bottle.off", "-o", tmp_path / "out.csv", "--set", "basis.size=600")
    assert ran.status == 0, ran.err
    assert "sharp edges" in ran.err
    found = table(tmp_path / "out.csv")
    assert (found["k1"] >= found["k2"]).all()
    np.testing.assert_allclose(found["k1"] * found["k2"], found["gaussian"], rtol=1e-12)


def test_what_cannot_be_measured_or_written_is_said_at_once(orbiframe, cube, tmp_path) -> None:
    ran = orbiframe("curvature", cube, "-o", tmp_path / "out.obj")
    assert (ran.status, ".ply .vtu .csv" in ran.err) == (1, True)
    ran = orbiframe("curvature", cube, "-o", cube)
    assert ran.status == 2
    open_box = tmp_path / "open.off"
    open_box.write_text(cube.read_text().replace("8 6 12", "8 5 12").replace("4 1 5 7 3\n", ""))
    ran = orbiframe("curvature", open_box, "-o", tmp_path / "out.csv")
    assert ran.status == 1
    assert not (tmp_path / "out.csv").exists()
    assert "Traceback" not in ran.err


@pytest.mark.long
def test_an_ellipsoid_of_1000_vertices(orbiframe, tmp_path) -> None:
    """K = 1 / (a b c s)^2 with s = x^2 / a^4 + y^2 / b^4 + z^2 / c^4, on triangles of evenly spread vertices."""
    from scipy.spatial import ConvexHull

    from orbiframe import Polyhedron

    number, axes = np.arange(1000) + 0.5, np.array([1, 0.7, 0.5])
    fall, turn = np.arccos(1 - number / 500), np.pi * (1 + np.sqrt(5)) * number
    x = np.stack([np.cos(turn) * np.sin(fall), np.sin(turn) * np.sin(fall), np.cos(fall)], axis=1)
    faces = ConvexHull(x).simplices
    inward = np.linalg.det(x[faces]) < 0
    faces[inward] = faces[inward][:, ::-1]
    mesh = saved(tmp_path / "ellipsoid.off", Polyhedron.from_faces(axes * x, faces))
    assert orbiframe("curvature", mesh, "-o", tmp_path / "out.csv").status == 0
    found = table(tmp_path / "out.csv")
    wanted = 1 / (axes.prod() * ((axes * x) ** 2 / axes**4).sum(axis=1)) ** 2
    assert np.abs(found["gaussian"] / wanted - 1).max() < 0.02
    assert np.abs(found["gaussian"] - wanted).max() < 0.01 * wanted.max()
