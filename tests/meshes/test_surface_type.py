"""Surface types, orientation and defects of known, random and broken polyhedra."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from random_polyhedra import NAMES, edges_of, face_lists, grown, random_polyhedra, relabelled

from orbiframe.errors import TopologyError
from orbiframe.meshes.defects import defects_of, require_closed_surface
from orbiframe.meshes.fans import fan_labels
from orbiframe.meshes.orientation import oriented, reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import vector_areas
from orbiframe.meshes.surface_type import SurfaceType, surface_type, without_unused_vertices
from orbiframe.testing.polyhedra import reference_polyhedra

# Name: Euler characteristic, orientable, handles or crosscaps.
KNOWN = {
    "tetrahedron": (2, True, 0),
    "cube": (2, True, 0),
    "prism": (2, True, 0),
    "torus": (0, True, 1),
    "double torus": (-2, True, 2),
    "projective plane": (1, False, 1),
    "Klein bottle": (0, False, 2),
}
SEEDS = st.integers(0, 2**32 - 1)


def found(mesh: Polyhedron) -> dict[str, tuple[int, str, bool]]:
    return {defect.kind: (defect.count, defect.where, defect.fatal) for defect in defects_of(mesh)}


def random_flips(mesh: Polyhedron, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).random(mesh.face_count) < 0.5


def flat(faces: list[list[int]]) -> Polyhedron:
    """Faces on distinct vertices in general position."""
    count = max(max(face, default=0) for face in faces) + 1
    return Polyhedron.from_faces(np.random.default_rng(1).normal(size=(count, 3)), faces)


def assert_twins_consistent(mesh: Polyhedron) -> None:
    h = np.flatnonzero(mesh.twin >= 0)
    t = mesh.twin[h]
    np.testing.assert_array_equal(mesh.twin[t], h)
    np.testing.assert_array_equal(mesh.same[t], mesh.same[h])
    np.testing.assert_array_equal(mesh.tail[h], np.where(mesh.same[h], mesh.tail[t], mesh.head[t]))
    np.testing.assert_array_equal(mesh.head[h], np.where(mesh.same[h], mesh.head[t], mesh.tail[t]))
    assert not mesh.same[mesh.twin < 0].any()


def test_every_reference_polyhedron_is_known() -> None:
    assert set(KNOWN) == set(NAMES)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(NAMES), SEEDS, st.integers(0, 15), SEEDS)
def test_type_survives_relabelling_reversal_and_subdivision(name: str, seed: int, steps: int, order: int) -> None:
    mesh = relabelled(grown(name, seed, steps), np.random.default_rng(order))
    chi, orientable, genus = KNOWN[name]
    assert chi == len(mesh.vertices) - len(edges_of(face_lists(mesh))) + mesh.face_count
    expected = SurfaceType(chi, orientable, True, 1, genus)
    assert surface_type(mesh) == surface_type(reversed_faces(mesh, random_flips(mesh, seed))) == expected
    assert require_closed_surface(mesh) == expected


@settings(max_examples=30, deadline=None)
@given(random_polyhedra(), SEEDS)
def test_oriented_faces_run_against_each_other(mesh: Polyhedron, seed: int) -> None:
    result = oriented(reversed_faces(mesh, random_flips(mesh, seed)))
    assert_twins_consistent(result)
    if surface_type(mesh).orientable:
        assert not result.same.any()
        assert len(set(zip(result.tail.tolist(), result.head.tolist(), strict=True))) == len(result.tail)
    else:
        assert result.same.any()


@settings(max_examples=30, deadline=None)
@given(random_polyhedra(), SEEDS)
def test_reversing_twice_changes_nothing_and_once_is_a_new_face_list(mesh: Polyhedron, seed: int) -> None:
    flip = random_flips(mesh, seed)
    once = reversed_faces(mesh, flip)
    assert_twins_consistent(once)
    faces = [face[:1] + face[:0:-1] if flip[i] else face for i, face in enumerate(face_lists(mesh))]
    again = Polyhedron.from_faces(mesh.vertices, faces)
    for name in ("offsets", "tail", "twin", "same"):
        np.testing.assert_array_equal(getattr(once, name), getattr(again, name))
        np.testing.assert_array_equal(getattr(reversed_faces(once, flip), name), getattr(mesh, name))


def test_reversing_an_open_polyhedron_keeps_its_boundary() -> None:
    two = flat([[0, 1, 2, 3], [0, 3, 4]])
    turned = reversed_faces(two, np.array([False, True]))
    assert_twins_consistent(turned)
    assert (turned.twin < 0).sum() == 5
    assert turned.same.sum() == 2


@pytest.mark.parametrize("turned", [1, 2, 3, 4, 5])
def test_majority_keeps_its_orientation(turned: int) -> None:
    cube = reference_polyhedra()["cube"]
    mixed = reversed_faces(cube, np.arange(6) < turned)
    kept = cube if turned < 3 else reversed_faces(cube, np.ones(6, dtype=bool))
    np.testing.assert_array_equal(oriented(mixed).tail, kept.tail)


def test_orientation_of_a_one_sided_surface_is_left_alone() -> None:
    mesh = reference_polyhedra()["projective plane"]
    assert oriented(mesh) is mesh


@pytest.mark.parametrize("name", [name for name in NAMES if KNOWN[name][1]])
def test_vector_areas_of_a_closed_oriented_surface_add_up_to_nothing(name: str) -> None:
    areas = vector_areas(oriented(grown(name, 3, 10)))
    assert np.abs(areas.sum(axis=0)).max() < 1e-12


def test_vector_area_of_a_known_polygon() -> None:
    ell = [[0, 0, 5], [3, 0, 5], [3, 1, 5], [1, 1, 5], [1, 4, 5], [0, 4, 5]]
    mesh = Polyhedron.from_faces(ell, [[0, 1, 2, 3, 4, 5], [5, 4, 3, 2, 1, 0], [2, 3, 4, 5, 0, 1]])
    np.testing.assert_allclose(vector_areas(mesh), [[0, 0, 6], [0, 0, -6], [0, 0, 6]], atol=1e-14)


# ---- names ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        (SurfaceType(-4, True, True, 1, 3), "closed, orientable, genus 3, 1 component"),
        (SurfaceType(1, False, True, 1, 1), "closed, nonorientable, 1 crosscap, 1 component"),
        (SurfaceType(-1, False, True, 1, 3), "closed, nonorientable, 3 crosscaps, 1 component"),
        (SurfaceType(4, True, True, 2, None), "closed, orientable, 2 components"),
        (SurfaceType(1, True, False, 1, None), "not closed, orientable, 1 component"),
    ],
)
def test_name_in_words(kind: SurfaceType, name: str) -> None:
    assert kind.name == name


# ---- defects --------------------------------------------------------------------------------------------------------


@settings(max_examples=20, deadline=None)
@given(random_polyhedra(), SEEDS)
def test_a_sound_polyhedron_has_no_defect_but_its_orientation(mesh: Polyhedron, seed: int) -> None:
    mixed = reversed_faces(oriented(mesh), random_flips(mesh, seed))
    turned = len({frozenset((int(mixed.tail[h]), int(mixed.head[h]))) for h in np.flatnonzero(mixed.same)})
    expected = {"inconsistently oriented edges": turned} if surface_type(mesh).orientable and turned else {}
    assert {kind: count for kind, (count, _, _) in found(mixed).items()} == expected
    assert not any(defect.fatal for defect in defects_of(mixed))


@settings(max_examples=20, deadline=None)
@given(random_polyhedra(), SEEDS)
def test_a_missing_face_leaves_one_loop_of_open_edges(mesh: Polyhedron, seed: int) -> None:
    faces = face_lists(mesh)
    lost = faces.pop(seed % len(faces))
    torn = Polyhedron.from_faces(mesh.vertices, faces)
    count, where, fatal = found(torn)["open edges"]
    assert (count, fatal) == (len(lost), True)
    assert where.startswith(f"1 boundary loop of {len(lost)} edges; first edge ")
    ends = sorted(edges_of([lost]))
    assert f"first edge {ends[0][0]}-{ends[0][1]} of face " in where
    assert not surface_type(torn).closed
    with pytest.raises(TopologyError, match=rf"{len(lost)} open edges \(1 boundary loop"):
        require_closed_surface(torn)


def test_two_boundary_loops_are_counted() -> None:
    cube = reference_polyhedra()["cube"]
    tube = Polyhedron.from_faces(cube.vertices, face_lists(cube)[2:])
    assert found(tube)["open edges"][1].startswith("2 boundary loops of 4, 4 edges")
    assert surface_type(tube).euler_characteristic == 0


def test_an_edge_in_three_faces_is_named_with_them() -> None:
    tetrahedron = reference_polyhedra()["tetrahedron"]
    fin = Polyhedron.from_faces(np.vstack([tetrahedron.vertices, [[5, 5, 5]]]), [*face_lists(tetrahedron), [2, 0, 4]])
    assert found(fin)["non-manifold edges"] == (1, "edge 0-2 lies in faces 0, 1, 4", True)
    assert found(fin)["open edges"][0] == 2
    with pytest.raises(TopologyError, match=r"1 non-manifold edge \(edge 0-2 lies in faces 0, 1, 4\)"):
        require_closed_surface(fin)


def test_a_vertex_where_two_surfaces_touch_is_named() -> None:
    faces = face_lists(reference_polyhedra()["tetrahedron"])
    other = [[{0: 3, 1: 4, 2: 5, 3: 6}[i] for i in face] for face in faces]
    touching = flat(faces + other)
    assert found(touching)["vertices of several fans"] == (1, "vertices 3 (2 fans)", True)
    assert found(touching)["components"] == (2, "of 4, 4 faces", True)
    assert surface_type(touching).genus is None
    with pytest.raises(TopologyError, match=r"1 vertex of several fans \(vertices 3 \(2 fans\)\)"):
        require_closed_surface(touching)


def test_a_sphere_with_two_points_made_one_is_pinched_though_connected() -> None:
    mesh = grown("tetrahedron", 4, 25)
    faces, count = face_lists(mesh), len(mesh.vertices)
    near = [{k for face in faces if i in face for k in face} for i in range(count)]
    keep, gone = next((i, j) for i, j in combinations(range(count), 2) if not near[i] & near[j])
    faces = [[keep if i == gone else i for i in face] for face in faces]
    pinched = without_unused_vertices(Polyhedron.from_faces(mesh.vertices, faces))
    assert {kind: value[:2] for kind, value in found(pinched).items()} == {
        "vertices of several fans": (1, f"vertices {keep} (2 fans)")
    }
    assert surface_type(pinched) == SurfaceType(1, True, True, 1, None)


def test_fans_of_a_closed_surface_are_its_vertices() -> None:
    for mesh in reference_polyhedra().values():
        count, label = fan_labels(mesh)
        assert count == len(mesh.vertices)
        assert len(np.unique(np.stack([label, mesh.tail]), axis=1).T) == count


@pytest.mark.parametrize("face", [[], [0], [0, 1]])
def test_faces_of_few_corners_are_named(face: list[int]) -> None:
    mesh = flat([[0, 1, 2], face])
    assert found(mesh)["faces of fewer than 3 corners"] == (1, "faces 1", True)
    with pytest.raises(TopologyError, match=r"1 face of fewer than 3 corners \(faces 1\)"):
        require_closed_surface(mesh)


def test_a_face_that_repeats_a_vertex_is_named() -> None:
    mesh = flat([[0, 1, 2], [3, 4, 3, 5], [6, 6, 7]])
    assert found(mesh)["faces with a repeated vertex"] == (2, "faces 1, 2", True)


def test_duplicate_faces_are_named_in_any_order_of_corners() -> None:
    cube = reference_polyhedra()["cube"]
    faces = face_lists(cube)
    twice = Polyhedron.from_faces(cube.vertices, [*faces, faces[2][::-1], faces[5][1:] + faces[5][:1]])
    assert found(twice)["duplicate faces"] == (2, "faces 2 and 6, 5 and 7", True)
    with pytest.raises(TopologyError, match=r"2 duplicate faces \(faces 2 and 6, 5 and 7\)"):
        require_closed_surface(twice)


def test_two_triangles_on_the_same_corners_are_a_sphere() -> None:
    pillow = flat([[0, 1, 2], [2, 1, 0]])
    assert found(pillow) == {"duplicate faces": (1, "faces 0 and 1", False)}
    assert require_closed_surface(pillow) == SurfaceType(2, True, True, 1, 0)


def test_flaws_that_stop_nothing_are_listed() -> None:
    cube = reference_polyhedra()["cube"]
    vertices = np.vstack([cube.vertices, [[9, 9, 9], [8, 8, 8]]])
    vertices[3] = vertices[1]
    mesh = Polyhedron.from_faces(vertices, face_lists(cube))
    assert found(mesh) == {
        "vertices in no face": (2, "vertices 8, 9", False),
        "coincident vertices": (2, "vertices 1, 3", False),
    }
    assert require_closed_surface(mesh).genus == 0


def test_a_face_without_area_is_named() -> None:
    mesh = reference_polyhedra()["tetrahedron"]
    vertices = mesh.vertices.copy()
    vertices[2] = (vertices[0] + vertices[1]) / 2
    assert found(mesh.with_vertices(vertices)) == {"faces without area": (1, "faces 0", False)}


@pytest.mark.parametrize("scale", [1e-300, 1e-150, 1e150, 1e300])
def test_defects_do_not_depend_on_the_scale(scale: float) -> None:
    for mesh in reference_polyhedra().values():
        assert found(mesh.with_vertices(mesh.vertices * scale)) == {}


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_coordinates_that_are_not_finite_are_fatal(bad: float) -> None:
    mesh = reference_polyhedra()["cube"]
    vertices = mesh.vertices.copy()
    vertices[5, 1] = bad
    with pytest.raises(TopologyError, match=r"1 vertex without finite coordinates \(vertices 5\)"):
        require_closed_surface(mesh.with_vertices(vertices))


@pytest.mark.parametrize("vertices", [0, 3])
def test_no_faces_at_all(vertices: int) -> None:
    mesh = Polyhedron.from_faces(np.eye(3)[:vertices], [])
    assert surface_type(mesh) == SurfaceType(0, True, False, 0, None)
    assert set(found(mesh)) == ({"vertices in no face"} if vertices else set())
    assert oriented(mesh).face_count == 0
    with pytest.raises(TopologyError, match="no faces"):
        require_closed_surface(mesh)


@settings(max_examples=80, deadline=None)
@given(st.lists(st.lists(st.integers(0, 5), max_size=5), max_size=6))
def test_any_face_list_is_described_without_a_crash(faces: list[list[int]]) -> None:
    mesh = Polyhedron.from_faces(np.random.default_rng(0).normal(size=(6, 3)), faces)
    kind = surface_type(mesh)
    fatal = [defect for defect in defects_of(mesh) if defect.fatal]
    assert kind.name
    assert all(defect.count > 0 and defect.where and str(defect) for defect in defects_of(mesh))
    assume(faces)
    if fatal:
        with pytest.raises(TopologyError):
            require_closed_surface(mesh)
    else:
        assert kind.closed
        assert kind.components == 1
        assert kind.genus is not None
        assert kind.euler_characteristic <= 2


def test_long_lists_of_elements_are_cut_short() -> None:
    assert found(flat([[0, 1, 2]] + [[3]] * 7))["faces of fewer than 3 corners"][1] == "faces 1, 2, 3, 4, 5, …"


def test_unused_vertices_are_left_out_with_their_normals_and_colours() -> None:
    normals, colors = np.arange(15.0).reshape(5, 3), np.arange(20.0).reshape(5, 4) / 20
    mesh = Polyhedron.from_corners(np.eye(5)[:, :3], [0, 3], [4, 0, 2], normals=normals, colors=colors)
    result = without_unused_vertices(mesh)
    np.testing.assert_array_equal(result.vertices[result.tail], mesh.vertices[mesh.tail])
    np.testing.assert_array_equal(result.normals, normals[[0, 2, 4]])
    np.testing.assert_array_equal(result.colors, colors[[0, 2, 4]])
    assert without_unused_vertices(result) is result
