"""The pipeline on meshes from outside; skipped where the folder beside the repository is absent."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest
from fitted import REGISTRY, config

from orbiframe.errors import TopologyError
from orbiframe.files import gate
from orbiframe.fitting import pipeline
from orbiframe.meshes.defects import require_closed_surface
from orbiframe.meshes.face_diagonals import triangulated
from orbiframe.meshes.orientation import oriented
from orbiframe.meshes.surface_type import surface_type, without_unused_vertices

FOLDER = Path(__file__).parents[2].parent / "shared" / "meshes"
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not FOLDER.is_dir(), reason="there is no folder shared/meshes beside the repository"),
]

# Euler characteristic and orientability, as the list of the folder says.
CLOSED = {
    "3torus.off": (-4, True),
    "P.off": (0, True),
    "anchor.off": (-6, True),
    "blobby-shuffled.off": (2, True),
    "cross_quad.off": (2, True),
    "crosscap_sphere_k3.off": (-1, False),
    "crosscap_torus_k1.off": (-1, False),
    "cube_q.off": (2, True),
    "cube_quad.off": (2, True),
    "eight.off": (-2, True),
    "gc_bob_small.ply": (0, True),
    "gc_dodecahedron_poly.obj": (2, True),
    "gc_spot.ply": (2, True),
    "hole.off": (0, True),
    "klein_24x12_q.off": (0, False),
    "knot1.off": (0, True),
    "odedstein_skull_low.obj": (-2, True),
    "odedstein_spot_control.obj": (2, True),
    "plate_g10_q.off": (-18, True),
    "plate_g2_q.off": (-2, True),
    "plate_g2_q_sub1.off": (-2, True),
    "plate_g3_tri.off": (-4, True),
    "plate_g5_q.off": (-8, True),
    "prim.off": (2, True),
    "rotor.off": (0, True),
    "rp2_6.off": (1, False),
    "rp2_boy.off": (1, False),
    "sphere.off": (2, True),
    "star.off": (2, True),
    "tetrahedron.off": (2, True),
    "torus_24x10_q.off": (0, True),
    "torus_csaszar7.off": (0, True),
    "torus_quad.off": (0, True),
}
MAP_ONLY = {"odedstein_boot.obj": (-22, True), "trimesh_plate_holes.STL": (-8, True)}
BROKEN = {
    "bones.off": "26 components",
    "polygon_mesh.off": "489 open edges",
    "quads_to_stitch.off": "20 open edges",
}


def test_every_mesh_of_the_folder_is_tried() -> None:
    present = {path.name for path in FOLDER.iterdir() if path.suffix.lower() in {".off", ".ply", ".obj", ".stl"}}
    assert present == {*CLOSED, *MAP_ONLY, *BROKEN}


@pytest.mark.parametrize("name", CLOSED)
def test_a_closed_mesh_gives_a_surface_of_its_kind(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what a reader leaves out
        result = pipeline.fit(FOLDER / name, config(150), REGISTRY)
    report, (chi, orientable) = result.report, CLOSED[name]
    found = surface_type(result.output)
    assert (found.euler_characteristic, found.orientable, found.closed, found.components) == (chi, orientable, True, 1)
    assert (report["surface"]["euler_characteristic"], report["surface"]["orientable"]) == (chi, orientable)
    assert report["map"]["not_positive"] == 0
    assert report["map"]["area_defect"] < 1e-9
    assert report["group"]["relation_defect"] < 1e-12
    assert report["fit"]["rms"] < 0.03


@pytest.mark.parametrize("name", MAP_ONLY)
def test_a_large_or_slender_mesh_is_mapped_as_it_is(name: str) -> None:
    mesh = gate.read(FOLDER / name, REGISTRY)
    kind = require_closed_surface(mesh)
    assert (kind.euler_characteristic, kind.orientable) == MAP_ONLY[name]
    triangles = oriented(triangulated(without_unused_vertices(mesh)))
    made = REGISTRY.load("parametrizer", "harmonic")(triangles, REGISTRY.load("geometry", "h2")(), None)
    assert made.not_positive == 0
    assert made.area_defect < 1e-9
    assert made.relation_defect < 1e-10


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_mesh_is_refused_with_its_flaw(name: str) -> None:
    with pytest.raises(TopologyError, match=BROKEN[name]):
        pipeline.fit(FOLDER / name, config(150), REGISTRY)
