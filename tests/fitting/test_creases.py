"""Creases from a mesh to a surface: sharp where they should be, smooth elsewhere, and back from a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import spline_checks as checks
from creased import cylinder, fitted_with_creases, mesh_of
from fitted import DATASETS, REGISTRY
from orbiframe_fitters.kinks import Kinks
from surface_files import changed, without_sums

from orbiframe.errors import ConfigError, FormatError, UsageError
from orbiframe.files.gate import write
from orbiframe.files.surface_file import load_surface, save_surface
from orbiframe.fitting import pipeline
from orbiframe.fitting.config import Config
from orbiframe.meshes.bending import bending
from orbiframe.meshes.sizes import vector_areas
from orbiframe.splines import Sectors
from orbiframe.surfaces.crease_quality import crease_quality

PLATE = "plate_genus2_coarse.off"


def test_a_polyhedron_is_kept_to_the_last_edge() -> None:
    """Between creases its faces are flat; so it lies in the space of the functions, and is found there."""
    report = fitted_with_creases(PLATE, size=600).report
    assert report["data"]["means"] == "facets"
    assert report["fit"]["size"] <= 2100
    assert report["fit"]["rms"] < 5e-7
    creases = report["creases"]
    assert creases["distance"] < 5e-5
    assert creases["angle"] < 0.1
    assert creases["kinks"][1] < 0.1
    assert report["shape"]["folded_share"] == 0
    assert (creases["corners"], creases["ends"]) == (24, 0)


def test_derivatives_jump_at_creases_and_hairs_alone() -> None:
    """Measured on the three coordinates of the surface, from both sides of every edge of every piece."""
    surface = fitted_with_creases(PLATE, size=600).surface
    basis, sectors = surface.basis, Sectors(surface.basis.domain)
    sides = checks.both_sides(basis)
    inverse = np.linalg.inv(np.swapaxes(basis.domain.corners, 1, 2))[sides.face]
    height = np.einsum("nij,nj->ni", inverse, sides.frame[:, :, 0])
    halfedge = 3 * sides.face + (np.abs(height).argmin(axis=1) + 1) % 3
    opened = sides.crossed & sectors.open[halfedge]
    for coordinate in surface.coefficients.T:
        for order in (0, 1):
            here = checks._derivatives(basis, coordinate, order, sides.face, sides.cell, sides.frame)
            there = checks._derivatives(basis, coordinate, order, sides.other_face, sides.other_cell, sides.other_frame)
            jump = np.abs(here - there).max(axis=1) / np.abs(here).max()
            assert jump[~opened | (order == 0)].max() < 1e-9
        assert jump[sides.crossed & basis.domain.creased[halfedge]].max() > 0.1


def test_a_cylinder_is_round_between_its_rims() -> None:
    """Against the cylinder itself: many times nearer to it than the facets are, and without a kink to be seen."""
    result = fitted_with_creases("cylinder", size=900)
    surface = result.surface
    assert result.report["data"]["means"] == "semi-smooth"
    assert result.report["creases"]["kinks"][1] < 0.1
    points = surface.triangulation.locate(
        np.arange(surface.triangulation.polyhedron.face_count),
        np.full((surface.triangulation.polyhedron.face_count, 3), 1 / 3),
    )
    x = surface.evaluate(points)
    wall = np.abs(x[:, 2] - 0.5) < 0.49
    off = np.abs(np.hypot(x[wall, 0], x[wall, 1]) - 0.5)
    facets = 0.5 * (1 - np.cos(np.pi / 24))
    assert np.sqrt(np.mean(off**2)) < facets / 10
    lids = np.abs(surface.normals(points)[:, 2]) > 0.99
    bulge = np.abs(np.abs(x[lids, 2] - 0.5) - 0.5)
    assert np.sqrt(np.mean(bulge**2)) < 3e-5
    assert bulge.max() < 5e-4


@pytest.mark.parametrize("name", [pytest.param("projective_plane.off", marks=pytest.mark.long), "klein_bottle.off"])
def test_nonorientable_surfaces_have_creases_too(name: str) -> None:
    report = fitted_with_creases(name, 30, 500, "data.means=facets").report
    assert report["creases"]["edges"] > 0
    assert report["fit"]["rms"] < 3e-3


def test_ps2_keeps_creases_as_well() -> None:
    report = fitted_with_creases("cube.off", 30, 300, "basis.name=ps2").report
    assert report["fit"]["rms"] < 5e-7
    assert report["creases"]["corners"] == 8


def test_without_an_angle_nothing_is_sharp() -> None:
    config = Config.load()
    assert config.data.creases is None
    assert config.basis.name == "gaussian"
    assert Config.load(overrides=["data.creases=30"]).basis.name == "clough-tocher"
    assert Config.load(overrides=["data.creases=30", "basis.name=ps2"]).basis.name == "ps2"


# ---- what was asked for wrongly -------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [0, -3, 180.5])
def test_angles_that_are_none(angle: float) -> None:
    with pytest.raises(ConfigError, match=r"data\.creases = .*(greater than 0|less than or equal to 180)"):
        Config.load(overrides=[f"data.creases={angle}"])


def test_a_mesh_without_a_crease() -> None:
    with pytest.raises(ConfigError, match=r"no edge of the mesh bends by 100° or more \(the sharpest by 90\.0°\)"):
        pipeline.fit(mesh_of("cube.off"), Config.load(overrides=["data.creases=100"]), REGISTRY)


@pytest.mark.parametrize("name", ["gaussian", "ps6"])
def test_functions_that_keep_none(name: str) -> None:
    with pytest.raises(ConfigError, match=f"functions '{name}' keep no creases .*: clough-tocher, ps2"):
        Config.load(overrides=["data.creases=30", f"basis.name={name}"])


# ---- output ---------------------------------------------------------------------------------------------------------


def test_corners_of_faces_have_the_normals_of_their_side() -> None:
    """All three corners of a triangle on a flat face have its normal, on creases as elsewhere."""
    output = fitted_with_creases(PLATE, size=600).output
    assert output.corner_normals is not None
    vectors = vector_areas(output)
    unit = vectors / np.linalg.norm(vectors, axis=1)[:, None]
    cosine = np.einsum("hi,hi->h", output.corner_normals, unit[output.face])
    assert cosine.min() > 1 - 1e-4
    of_vertices = np.einsum("hi,hi->h", output.normals[output.tail], unit[output.face])
    assert of_vertices.min() < 0.1


def test_creases_are_edges_of_the_output() -> None:
    mesh, output = mesh_of(PLATE), fitted_with_creases(PLATE, size=600).output
    before, after = bending(mesh), bending(output)
    length = [(m.edge_lengths * (b.angle > 0.5)).sum() for m, b in ((mesh, before), (output, after))]
    assert length[1] == pytest.approx(length[0], rel=1e-5)
    assert ((after.angle < 0.01) | (np.abs(after.angle - np.pi / 2) < 0.02)).all()


def test_obj_files_have_normals_of_corners(tmp_path: Path) -> None:
    output = fitted_with_creases("cube.off", 30, 300, "basis.name=ps2").output
    write(tmp_path / "cube.obj", output, REGISTRY)
    lines = (tmp_path / "cube.obj").read_text().splitlines()
    normals = np.array([line.split()[1:] for line in lines if line.startswith("vn ")], dtype=float)
    faces = [[tuple(map(int, word.split("//"))) for word in line.split()[1:]] for line in lines if line[:2] == "f "]
    assert len(faces) == output.face_count
    found = np.array([normals[n - 1] for face in faces for _, n in face])
    np.testing.assert_array_equal(found, output.corner_normals)
    np.testing.assert_array_equal([v - 1 for face in faces for v, _ in face], output.tail)


def test_quality_is_none_without_creases() -> None:
    surface = fitted_with_creases("cube.off", 30, 300, "basis.name=ps2").surface
    assert crease_quality(surface) is not None
    plain = replace(surface, triangulation=replace(surface.triangulation, crease=None, sites=None))
    assert crease_quality(plain) is None
    assert Kinks.of(surface.basis) is not None


# ---- files ----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("surface") / "plate.npz"
    save_surface(fitted_with_creases(PLATE, size=600).surface, path)
    return path


def test_a_saved_surface_has_its_creases(saved: Path) -> None:
    surface, again = fitted_with_creases(PLATE, size=600).surface, load_surface(saved, REGISTRY)
    np.testing.assert_array_equal(again.basis.domain.creased, surface.basis.domain.creased)
    one, other = surface.tessellate(2), again.tessellate(2)
    np.testing.assert_array_equal(one.vertices, other.vertices)
    np.testing.assert_array_equal(one.corner_normals, other.corner_normals)


def _put(name: str, place: int, value: object):  # type: ignore[no-untyped-def]
    def change(arrays: dict[str, np.ndarray]) -> None:
        arrays[name] = arrays[name].copy()
        arrays[name][place] = value

    return change


def _one_side(arrays: dict[str, np.ndarray]) -> None:
    first = int(np.flatnonzero(arrays["crease"])[0])
    _put("crease", first, False)(arrays)


def _one_side_of_a_seam(arrays: dict[str, np.ndarray]) -> None:
    arrays["seam"] = arrays["crease"].copy()
    arrays["seam"][np.flatnonzero(arrays["crease"])[0]] = False


def _without_a_corner(arrays: dict[str, np.ndarray]) -> None:
    tail = arrays["fine_tail"][arrays["crease"]]
    corner = np.flatnonzero(np.bincount(tail) == 3)[0]
    arrays["sites"] = arrays["sites"][arrays["sites"] != corner]


def _beside_its_geodesic(arrays: dict[str, np.ndarray]) -> None:
    on_crease = np.unique(arrays["fine_tail"][arrays["crease"]])
    vertex = np.setdiff1d(on_crease, arrays["sites"])[0]
    x = arrays["points"] = arrays["points"].copy()
    x[vertex, 1:] += 1e-4
    x[vertex, 0] = np.sqrt(1 + x[vertex, 1] ** 2 + x[vertex, 2] ** 2)


def _few_sites(arrays: dict[str, np.ndarray]) -> None:
    tail = arrays["fine_tail"][arrays["crease"]]
    count = np.bincount(tail, minlength=len(arrays["points"]))
    arrays["sites"] = np.flatnonzero(count >= 3)


BROKEN = {
    "creases without sites": (lambda a: a.pop("sites"), "sites", "sites if there are creases"),
    "sites without creases": (lambda a: a.pop("crease"), "sites", "sites if there are creases"),
    "one halfedge of two": (_one_side, "crease", "both halfedges"),
    "no crease at all": (lambda a: a.update(crease=np.zeros_like(a["crease"])), "crease", "there is a crease"),
    "a site out of range": (_put("sites", 0, 10**6), "sites", "vertices are 0 to"),
    "a site twice": (lambda a: a.update(sites=np.append(a["sites"], a["sites"][0])), "sites", "different"),
    "a corner that is no site": (_without_a_corner, "sites", "ends and corners"),
    "seams that are no creases": (lambda a: a.update(seam=~a["crease"]), "seam", "seams are among the creases"),
    "one halfedge of a seam": (_one_side_of_a_seam, "seam", "both halfedges"),
    "a crease beside its geodesic": (_beside_its_geodesic, "points", "along geodesics from site to site"),
    "sites without their edges": (_few_sites, "(points|sites)", "(along geodesics|Delaunay)"),
}


@pytest.mark.parametrize("case", list(BROKEN))
def test_files_whose_creases_break_a_law(saved: Path, tmp_path: Path, case: str) -> None:
    change, array, law = BROKEN[case]

    def both(arrays: dict[str, np.ndarray]) -> None:
        change(arrays)
        without_sums(arrays)

    with pytest.raises(FormatError, match=f"the array '{array}' breaks a law: .*{law}"):
        load_surface(changed(saved, tmp_path / "other.npz", both), REGISTRY)


def test_a_file_with_sound_creases_and_no_sums_is_read(saved: Path, tmp_path: Path) -> None:
    """So that it is the laws that tell, and nothing else."""
    load_surface(changed(saved, tmp_path / "other.npz", without_sums), REGISTRY)


def test_a_cylinder_of_the_tests_is_one() -> None:
    x = cylinder(24).vertices
    np.testing.assert_allclose(np.hypot(x[:, 0], x[:, 1]), 0.5)
    assert (DATASETS / PLATE).exists()
    assert issubclass(UsageError, Exception)


def test_elements_of_a_creased_surface_do_not_straddle_creases() -> None:
    """Every triangle lies on one face of the polyhedron: its corners and middles are in one plane."""
    from orbiframe.surfaces import curved_mesh, input_faces

    surface = fitted_with_creases(PLATE, size=600).surface
    mesh = curved_mesh(surface, input_faces(surface), 2, 1)
    nodes = mesh.nodes[mesh.elements]
    sizes = np.linalg.svd(nodes - nodes.mean(axis=1, keepdims=True), compute_uv=False)
    assert (sizes[:, 2] < 1e-4 * sizes[:, 0]).all()


@pytest.mark.parametrize("name", ["cube.off", PLATE])
def test_cad_files_have_every_crease_as_edges_at_its_angle(tmp_path: Path, name: str) -> None:
    """Read back by Open CASCADE: a valid solid; its sharp edges are as long as those of the mesh, at right angles."""
    pytest.importorskip("OCP", reason='Open CASCADE is the extra "orbiframe[cad]"')
    import opened_shapes as opened

    options = (30, 300, "basis.name=ps2") if name == "cube.off" else (30, 600)
    shape = opened.reopened(fitted_with_creases(name, *options).surface, tmp_path / "creased.step")
    assert opened.is_valid(shape)
    assert opened.is_solid(shape)
    edges, mesh = opened.angles_at_edges(shape), mesh_of(name)
    sharp, wanted = edges[:, 1] > 1, bending(mesh).angle > 0.5
    assert edges[sharp, 0].sum() == pytest.approx((mesh.edge_lengths * wanted * mesh.representative).sum(), rel=1e-4)
    assert np.abs(edges[sharp, 1] - 90).max() < 0.5
    volume = np.linalg.det(mesh.vertices[mesh.triangles]).sum() / 6
    assert opened.volume(shape) == pytest.approx(volume, rel=1e-4)
