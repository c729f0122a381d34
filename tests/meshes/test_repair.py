"""Repairs: random damage is undone, and what was changed is said."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from random_polyhedra import NAMES, face_lists, grown, random_polyhedra

from orbiframe.errors import TopologyError, UsageError
from orbiframe.meshes import repair
from orbiframe.meshes.defects import defects_of, require_closed_surface
from orbiframe.meshes.flat_faces import simple_loops
from orbiframe.meshes.open_edges import open_halfedges, seams
from orbiframe.meshes.orientation import oriented, reversed_faces
from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.meshes.sizes import area, faces_without_area, signed_volume
from orbiframe.meshes.surface_type import surface_type, without_unused_vertices
from orbiframe.testing.polyhedra import reference_polyhedra

SEEDS = st.integers(0, 2**32 - 1)
MESHES = reference_polyhedra()


def taken_apart(mesh: Polyhedron, noise: float, seed: int) -> Polyhedron:
    points = mesh.vertices[mesh.tail]
    shift = np.random.default_rng(seed).uniform(-noise, noise, points.shape)
    return Polyhedron.from_corners(points + shift, mesh.offsets, np.arange(len(mesh.tail)))


def side_by_side(*meshes: Polyhedron) -> Polyhedron:
    """A union without anything in common, ten apart."""
    faces, points, count = [], [], 0
    for k, mesh in enumerate(meshes):
        faces += [[c + count for c in face] for face in face_lists(mesh)]
        points.append(mesh.vertices + np.array([100 * k, 0, 0]))
        count += len(mesh.vertices)
    return Polyhedron.from_faces(np.vstack(points), faces)


def geometry_of(mesh: Polyhedron) -> Counter[frozenset[tuple[float, ...]]]:
    return Counter(frozenset(map(tuple, mesh.vertices[mesh.face_corners(f)].tolist())) for f in range(mesh.face_count))


def kinds(mesh: Polyhedron) -> set[str]:
    return {defect.kind for defect in defects_of(mesh)}


# ---- weld -----------------------------------------------------------------------------------------------------------


@settings(max_examples=30, deadline=None)
@given(random_polyhedra(), SEEDS, st.sampled_from([0.0, 1e-9, 1e-6]))
def test_a_weld_restores_the_surface_of_a_mesh_taken_apart(mesh: Polyhedron, seed: int, noise: float) -> None:
    apart = taken_apart(mesh, noise, seed)
    whole, said = repair.weld(apart, seams(apart).tolerance)
    assert surface_type(whole) == surface_type(mesh)
    assert len(whole.vertices) == len(mesh.vertices)
    assert f"{len(mesh.tail)} vertices became {len(mesh.vertices)}" in said
    assert f"open edges: {len(mesh.tail)} before, 0 after" in said
    if noise == 0:
        assert geometry_of(whole) == geometry_of(mesh)


@settings(max_examples=30, deadline=None)
@given(random_polyhedra(), SEEDS, st.floats(0, 0.3))
def test_a_weld_of_any_width_leaves_simple_faces_and_is_done_at_once(mesh: Polyhedron, seed: int, width: float) -> None:
    apart = taken_apart(mesh, 0.1, seed)
    welded, _ = repair.weld(apart, width)
    assert not kinds(welded) & {"faces with a repeated vertex", "faces of fewer than 3 corners"}
    again, said = repair.weld(welded, width)
    assert again is welded
    assert said.endswith(repair.NOTHING)


def test_an_edge_that_is_welded_away_leaves_no_hole() -> None:
    mesh = grown("torus", 5, 20)
    shortest = int(np.argmin(mesh.edge_lengths))
    ends = mesh.tail[shortest], mesh.head[shortest]
    vertices = mesh.vertices.copy()
    vertices[ends[1]] = vertices[ends[0]]
    welded, said = repair.weld(mesh.with_vertices(vertices), 0)
    assert len(welded.vertices) == len(mesh.vertices) - 1
    assert "open edges" not in said
    assert len(open_halfedges(welded)) == 0


def test_a_weld_of_everything_is_refused() -> None:
    with pytest.raises(TopologyError, match="smaller tolerance"):
        repair.weld(MESHES["cube"], 1.0)


def test_chains_are_said_and_the_first_vertex_stays() -> None:
    points = [[0, 0, 0], [5, 0, 0], [0, 5, 0], [0.9, 0, 0], [5, 5, 0], [1.8, 0, 0], [0, 0, 7]]
    welded, said = repair.weld(Polyhedron.from_faces(points, [[0, 1, 2], [3, 1, 4], [5, 4, 6]]), 1.0)
    assert "moved by at most 1.8, in chains" in said
    assert welded.vertices.tolist() == [[0, 0, 0], [5, 0, 0], [0, 5, 0], [5, 5, 0], [0, 0, 7]]
    assert face_lists(welded) == [[0, 1, 2], [0, 1, 3], [0, 3, 4]]


def test_normals_and_colours_of_a_cluster_become_means() -> None:
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [1, 1, 1]]
    mesh = replace(
        Polyhedron.from_faces(points, [[0, 1, 2], [3, 1, 4]]),
        normals=np.array([[1, 0, 0], [0, 0, 3], [0, 0, 1], [0, 1, 0], [0, 2, 0.0]]),
        colors=np.array([[0, 0, 0], [0.1, 0.2, 0.3], [1, 1, 1], [1, 0, 0.5], [1, 0, 1]]),
        face_colors=np.array([[0.5, 0, 0], [0, 0.5, 0]]),
    )
    welded, _ = repair.weld(mesh, 0)
    np.testing.assert_allclose(welded.normals, [[0.5**0.5, 0.5**0.5, 0], [0, 0, 3], [0, 0, 1], [0, 2, 0]])
    np.testing.assert_array_equal(welded.colors, [[0.5, 0, 0.25], [0.1, 0.2, 0.3], [1, 1, 1], [1, 0, 1]])
    np.testing.assert_array_equal(welded.face_colors, mesh.face_colors)


@pytest.mark.parametrize("tolerance", [-1.0, np.inf, np.nan])
def test_a_tolerance_is_a_length(tolerance: float) -> None:
    with pytest.raises(UsageError, match="finite number"):
        repair.weld(MESHES["cube"], tolerance)


# ---- degenerate faces -----------------------------------------------------------------------------------------------


@settings(max_examples=100, deadline=None)
@given(st.lists(st.integers(0, 5), max_size=12))
def test_loops_of_a_walk_are_simple_and_keep_each_edge_that_is_walked_an_odd_number_of_times(walk: list[int]) -> None:
    def parity(faces: list[list[int]]) -> set[frozenset[int]]:
        edges = Counter(frozenset(e) for face in faces for e in zip(face, face[1:] + face[:1], strict=True))
        return {edge for edge, count in edges.items() if count % 2 and len(edge) == 2}

    loops = simple_loops(walk)
    assert all(len(set(loop)) == len(loop) >= 3 for loop in loops)
    assert parity(loops) == parity([walk])


@settings(max_examples=30, deadline=None)
@given(random_polyhedra(), SEEDS, st.integers(1, 4))
def test_damage_by_extra_faces_and_vertices_is_undone(mesh: Polyhedron, seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    faces = face_lists(mesh)
    for _ in range(count):
        again = faces[rng.integers(mesh.face_count)]
        a, b = rng.permutation(len(mesh.vertices))[:2].tolist()
        faces += [[again[::-1], np.roll(again, 1).tolist(), [a, b, a, b], [a, a, b]][rng.integers(4)]]
    damaged = Polyhedron.from_faces(np.vstack([mesh.vertices, rng.random((2, 3))]), faces)
    mended, said = repair.drop_degenerate(damaged)
    assert geometry_of(mended) == geometry_of(mesh)
    assert surface_type(mended) == surface_type(mesh)
    assert "2 vertices in no face dropped" in said


@settings(max_examples=30, deadline=None)
@given(random_polyhedra(), SEEDS, st.integers(1, 4))
def test_faces_without_area_go_without_a_hole(mesh: Polyhedron, seed: int, count: int) -> None:
    """A face with a new vertex on an edge, cut from that edge by a triangle without area, any number of times."""
    rng = np.random.default_rng(seed)
    vertices, faces = mesh.vertices.tolist(), face_lists(mesh)
    for _ in range(count):
        chosen = int(rng.integers(len(faces)))
        a, b, *rest = np.roll(faces[chosen], rng.integers(len(faces[chosen]))).tolist()
        vertices.append(((np.array(vertices[a]) + vertices[b]) / 2).tolist())
        faces[chosen] = [a, len(vertices) - 1, b, *rest]
        faces.append([a, b, len(vertices) - 1])
    damaged = Polyhedron.from_faces(vertices, faces)
    assume(len(faces_without_area(damaged)) == count and not len(faces_without_area(mesh)))
    mended, said = repair.drop_degenerate(damaged)
    assert surface_type(mended) == surface_type(damaged) == surface_type(mesh)
    assert len(faces_without_area(mended)) == 0
    assert mended.face_count == mesh.face_count
    assert f"{count} face{'s' * (count > 1)} without area joined to a neighbour" in said
    assert "open" not in said


def test_a_face_without_area_goes_where_its_longest_edge_is_open() -> None:
    mesh = Polyhedron.from_faces([[0, 0, 0], [2, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 2, 3], [2, 1, 3], [0, 1, 2]])
    mended, said = repair.drop_degenerate(mesh)
    assert face_lists(mended) == [[0, 2, 3], [2, 1, 3]]
    assert said == "1 face without area dropped; open edges: 3 before, 4 after"


def test_a_face_without_area_stays_where_no_neighbour_can_take_it() -> None:
    """A flat pillow: two triangles on one line, glued along all edges."""
    pillow = Polyhedron.from_faces([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2], [2, 1, 0]])
    same, said = repair.drop_degenerate(pillow)
    assert same is pillow
    assert said == f"2 faces without area kept, as no neighbour can take them; {repair.NOTHING}"


def test_two_triangles_that_close_up_are_no_duplicates() -> None:
    pillow = Polyhedron.from_faces(np.eye(3), [[0, 1, 2], [2, 1, 0]])
    assert repair.drop_degenerate(pillow).polyhedron is pillow


def test_a_mesh_of_nothing_but_degenerate_faces_is_refused() -> None:
    with pytest.raises(TopologyError, match="nothing is left"):
        repair.drop_degenerate(Polyhedron.from_faces(np.eye(3), [[0, 1, 0, 1]]))


def test_colours_stay_with_their_faces() -> None:
    mesh = MESHES["cube"]
    faces = [[0, 1, 0], *face_lists(mesh), [0, 1, 3, 2]]
    shades = np.linspace(0, 1, 24).reshape(8, 3)
    mended, _ = repair.drop_degenerate(replace(Polyhedron.from_faces(mesh.vertices, faces), face_colors=shades))
    np.testing.assert_array_equal(mended.face_colors, shades[1:7])


# ---- fans -----------------------------------------------------------------------------------------------------------


@settings(max_examples=40, deadline=None)
@given(st.lists(st.sampled_from(NAMES), min_size=2, max_size=4), SEEDS)
def test_solids_that_touch_in_vertices_come_apart(names: list[str], seed: int) -> None:
    rng = np.random.default_rng(seed)
    parts = [MESHES[name] for name in names]
    union = side_by_side(*parts)
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    number = np.arange(len(union.vertices))
    for k in range(1, len(parts)):
        number[rng.integers(starts[k], starts[k + 1])] = rng.integers(starts[k - 1], starts[k])
    touching = Polyhedron.from_corners(union.vertices, union.offsets, number[number[union.tail]])
    assert "vertices of several fans" in kinds(touching)
    split, said = repair.split_nonmanifold_vertices(touching)
    whole = without_unused_vertices(split)
    assert kinds(whole) <= {"components", "inconsistently oriented edges", "coincident vertices"}
    assert surface_type(whole) == surface_type(union)
    assert "split" in said
    np.testing.assert_array_equal(split.vertices[split.tail], touching.vertices[touching.tail])
    for k, part in enumerate(sorted(parts, key=lambda part: -part.face_count), start=1):
        assert require_closed_surface(repair.component(split, k).polyhedron).closed, part


def test_solids_that_share_an_edge_come_apart() -> None:
    cube = MESHES["cube"]
    shared = {0: 6, 1: 7}
    other = [[shared.get(c, c + 8) for c in face] for face in face_lists(cube)]
    both = Polyhedron.from_faces(
        np.vstack([cube.vertices, cube.vertices + np.array([1, 1, 0])]), face_lists(cube) + other
    )
    assert {"non-manifold edges", "vertices of several fans"} <= kinds(both)
    split, said = repair.split_nonmanifold_vertices(both)
    assert said == "2 vertices of several fans split, 2 added"
    assert kinds(without_unused_vertices(split)) == {"components", "coincident vertices"}


def test_a_fin_on_an_edge_is_cut_off() -> None:
    cube = MESHES["cube"]
    fin = Polyhedron.from_faces(np.vstack([cube.vertices, [[5, 5, 5]]]), [*face_lists(cube), [0, 1, 8]])
    split, said = repair.split_nonmanifold_vertices(fin)
    assert "remain" not in said
    assert require_closed_surface(repair.component(split).polyhedron) == surface_type(cube)


def test_an_edge_whose_ends_have_one_fan_stays_and_is_said() -> None:
    mesh = MESHES["torus"]
    inner = Polyhedron.from_faces(
        np.vstack([mesh.vertices, [[0, 0, 1]]]), [*face_lists(mesh), [0, 1, 2], [7, 0, 1], [7, 1, 2], [7, 2, 0]]
    )
    _, said = repair.split_nonmanifold_vertices(inner)
    assert "remain" in said or "open edges" in said


# ---- components, orientation, triangles -----------------------------------------------------------------------------


@settings(max_examples=30, deadline=None)
@given(st.lists(st.sampled_from(NAMES), min_size=2, max_size=4), SEEDS)
def test_each_component_of_a_union_comes_back(names: list[str], seed: int) -> None:
    parts = [grown(name, seed + k, 3) for k, name in enumerate(names)]
    union = side_by_side(*parts)
    found = [repair.component(union, number).polyhedron for number in range(1, len(parts) + 1)]
    sizes = [mesh.face_count for mesh in found]
    assert sizes == sorted((part.face_count for part in parts), reverse=True)
    assert sum(map(geometry_of, found), Counter()) == geometry_of(union)
    assert Counter(map(surface_type, found)) == Counter(map(surface_type, parts))
    largest, said = repair.component(union)
    np.testing.assert_array_equal(largest.vertices, found[0].vertices)
    assert said == f"component 1 of {len(parts)} kept, with {sizes[0]} of {sum(sizes)} faces"


@pytest.mark.parametrize("number", [0, 3, -1])
def test_a_component_that_is_not_there_is_named(number: int) -> None:
    with pytest.raises(UsageError, match=r"1 to 2, of 6, 4 faces"):
        repair.component(side_by_side(MESHES["tetrahedron"], MESHES["cube"]), number)


@settings(max_examples=30, deadline=None)
@given(random_polyhedra(), SEEDS)
def test_faces_run_alike_and_outward(mesh: Polyhedron, seed: int) -> None:
    flip = np.random.default_rng(seed).random(mesh.face_count) < 0.7
    turned, said = repair.orient(reversed_faces(mesh, flip))
    if not surface_type(mesh).orientable:
        assert "nonorientable" in said
        return
    assert not turned.same.any()
    assert signed_volume(turned) >= 0
    again, said = repair.orient(turned)
    assert again is turned
    assert said == f"the faces run alike and outward; {repair.NOTHING}"


def test_the_reversed_faces_are_counted() -> None:
    cube = oriented(MESHES["cube"])
    assert repair.orient(reversed_faces(cube, np.arange(6) < 2)).said == "2 of 6 faces reversed"
    inward = reversed_faces(cube, np.ones(6, dtype=bool))
    assert repair.orient(inward).said == "6 of 6 faces reversed, as most looked inward"
    assert signed_volume(repair.orient(inward).polyhedron) == pytest.approx(1)


@settings(max_examples=20, deadline=None)
@given(random_polyhedra())
def test_triangles_keep_the_surface(mesh: Polyhedron) -> None:
    cut, said = repair.triangulate(mesh)
    assert cut.is_triangular
    assert surface_type(cut) == surface_type(mesh)
    assert (cut is mesh) == said.endswith(repair.NOTHING)


def test_concave_faces_are_cut_without_overlap() -> None:
    outline = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 1, 0], [0, 4, 0]]
    mesh = Polyhedron.from_faces(outline, [[0, 1, 2, 3, 4]])
    cut, said = repair.triangulate(mesh)
    assert said == "1 face of more than 3 corners cut into 3 triangles"
    assert area(cut) == pytest.approx(area(mesh)) == 10


@pytest.mark.parametrize("name", NAMES)
def test_a_sound_mesh_is_returned_itself(name: str) -> None:
    mesh = repair.orient(repair.triangulate(MESHES[name])[0])[0]
    for function, arguments in (
        (repair.weld, (1e-6,)),
        (repair.drop_degenerate, ()),
        (repair.split_nonmanifold_vertices, ()),
        (repair.component, ()),
        (repair.orient, ()),
        (repair.triangulate, ()),
    ):
        same, said = function(mesh, *arguments)
        assert same is mesh
        assert said.endswith(repair.NOTHING)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.lists(st.integers(0, 6), min_size=3, max_size=5), min_size=1, max_size=8), SEEDS)
def test_any_face_list_is_repaired_or_refused(faces: list[list[int]], seed: int) -> None:
    mesh = Polyhedron.from_faces(np.random.default_rng(seed).integers(0, 3, (7, 3)) / 2, faces)
    try:
        mesh = repair.drop_degenerate(repair.weld(mesh, 0.0).polyhedron).polyhedron
    except TopologyError:
        assert len(faces_without_area(mesh)) == mesh.face_count
        return
    for function in (repair.split_nonmanifold_vertices, repair.component, repair.orient, repair.triangulate):
        mesh = function(mesh).polyhedron
    assert mesh.is_triangular
    assert not kinds(mesh) & {"faces with a repeated vertex", "faces of fewer than 3 corners", "components"}
