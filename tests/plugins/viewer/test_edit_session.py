"""Sessions of the editor: the picture is the linear fit, files make the surface again, and nothing unsaved is lost."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from edits import DATASETS, REGISTRY, base_of, first, session_of
from open_shapes import cylinder
from orbiframe_viewer.edit_session import EditSession
from orbiframe_viewer.edited_fit import edited_fit
from orbiframe_viewer.first_fit import first_fit

from orbiframe import Config, fit, load_surface, read, save_surface


def quiet(*_):
    return None


@pytest.fixture
def at_work(tmp_path):
    """Starts the work of sessions, and ends it."""
    begun = []

    def started(session):
        thread = threading.Thread(target=session.work, daemon=True)
        begun.append((session, thread))
        thread.start()
        return session

    yield started
    for session, thread in begun:
        session.end()
        thread.join(60)


def settled(session):
    until = time.monotonic() + 60
    while not (session.state["fitted"] and not session.state["working"] and not session.state["saving"]):
        assert not session.state["error"], session.state["error"]
        assert time.monotonic() < until
        time.sleep(0.02)


def sent(session, name, **body):
    answer = session.sent(name, body)
    assert answer is not None
    return answer.status, json.loads(answer.content)


@pytest.mark.parametrize("name", ["plate_genus2_coarse", "torus", "projective_plane"])
def test_the_picture_moves_as_the_linear_fit_of_the_moved_values(name):
    """Against the fitter itself: the same samples with the values of the moved mesh, all else as before."""
    found = first(name, 60)
    surface, samples = found.result.surface, found.result.samples
    vertex, way = 3, np.array([0.03, -0.02, 0.05]) * surface.scale
    draft = found.draft.with_vertex(vertex, way)
    shares = found.influence._shares[:, [vertex]].toarray()
    counted = samples.weights > 0
    assert shares[counted].max() > 0.3
    fitter = REGISTRY.load("fitter", "least-squares")(fairing=found.draft.fitter.get("fairing"))
    from dataclasses import replace

    moved = replace(samples, values=samples.values + shares * way / surface.scale)
    # As much fairing as the samples before ask for: values that are moved could ask for more.
    base = fitter.prepared(surface.basis, samples)
    difference = base(moved.values) - base(samples.values)
    wanted = surface.scale * (surface.basis.design_matrix(found.display.points) @ difference)
    shown = found.shown(draft)[0] - found.shown(found.draft)[0]
    assert np.abs(shown - wanted).max() < 1e-9 * surface.scale
    assert np.abs(shown).max() > 0.2 * np.abs(way).max()


@pytest.mark.parametrize("name", ["plate_genus2_coarse", "three_crosscaps"])
def test_shares_put_the_samples_where_they_are(name):
    """Facets: the vertices, each with its share, make the values of all samples."""
    found = first(name, 60, "data.means=facets")
    mesh, samples = found.result.surface.refinement.coarse, found.result.samples
    assert np.abs(found.influence._shares @ mesh.vertices - samples.values).max() < 1e-9


def test_a_prepared_fit_is_the_fit():
    found = first("torus", 60)
    surface, samples = found.result.surface, found.result.samples
    for fairing in (None, 0.0, 0.01):
        fitter = REGISTRY.load("fitter", "least-squares")(fairing=fairing)
        whole = fitter.fit(surface.basis, samples)
        again = fitter.prepared(surface.basis, samples)(samples.values)
        points = found.display.points
        matrix = surface.basis.design_matrix(points)
        assert np.abs(matrix @ (again - whole)).max() < 1e-8


def test_what_the_page_shows_are_points_and_normals_of_the_surface():
    found = first("plate_genus2_coarse", 60)
    surface, display = found.surface, found.display
    shown = found.shown(found.draft)
    assert np.abs(shown[0] - surface.evaluate(display.points)).max() < 1e-12 * surface.scale
    normal = np.cross(shown[1], shown[2])[: display.count]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    corners = shown[0][display.triangles]
    facets = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facets /= np.maximum(np.linalg.norm(facets, axis=1, keepdims=True), 1e-300)
    assert np.median(np.einsum("fi,fi->f", facets, normal[display.triangles[:, 0]])) > 0.9
    assert len(display.points.patch) >= 16_000


def test_the_files_make_the_surface_again(at_work, orbiframe, tmp_path, monkeypatch):
    """Vertices and control points moved, saved, and fitted by the command with the configuration."""
    session = at_work(session_of(first("plate_genus2_coarse", 80), tmp_path / "plate.off"))
    sent(session, "move", vertex=3, by=[0.1, -0.05, 0.08])
    settled(session)
    sent(session, "move", control=7, by=[0.05, 0.0, 0.02])
    settled(session)
    sent(session, "save")
    settled(session)
    assert {each.name for each in tmp_path.iterdir()} == {"plate.off", "plate.npz", "plate.toml"}
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("fit", "plate.off", "--config", "plate.toml", "-o", "again.ply", "--save", "again.npz", "--json")
    assert ran.status == 0, ran.err
    assert json.loads(ran.out)["map"]["like"]["same_triangles"]
    saved, again = (load_surface(tmp_path / name, REGISTRY) for name in ("plate.npz", "again.npz"))
    points = session.fit.display.points
    assert np.abs(saved.evaluate(points) - again.evaluate(points)).max() <= 1e-9 * saved.scale
    assert np.abs(saved.evaluate(points) - session.fit.shown(session.history.now)[0]).max() <= 1e-9 * saved.scale


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("torus", ()),
        ("plate_genus3", ("basis.name=ps2",)),
        ("sphere", ("data.means=smooth",)),
        ("plate_genus2_coarse", ("data.creases=30",)),
    ],
)
def test_smooth_meshes_and_other_functions_are_made_again_too(at_work, tmp_path, name, options):
    session = at_work(session_of(first(name, 80, *options), tmp_path / "shape.off", *options))
    sent(session, "move", vertex=1, by=list(0.02 * session._scale * np.ones(3)))
    settled(session)
    sent(session, "save")
    settled(session)
    found = fit(tmp_path / "shape.off", Config.load(tmp_path / "shape.toml"), REGISTRY, progress=False)
    points = session.fit.display.points
    apart = found.surface.evaluate(points) - session.fit.surface.evaluate(points)
    assert np.abs(apart).max() <= 1e-9 * found.surface.scale


@pytest.mark.long
def test_a_mesh_with_a_boundary_is_edited_too(at_work, tmp_path):
    base = base_of(100, "mesh.boundary=auto")
    found = first_fit(cylinder(), None, base, REGISTRY, quiet)[1]
    session = at_work(session_of(found, tmp_path / "tube.off", "mesh.boundary=auto"))
    sent(session, "move", vertex=2, by=[0.05, 0.02, 0.0])
    settled(session)
    sent(session, "save")
    settled(session)
    again = fit(tmp_path / "tube.off", Config.load(tmp_path / "tube.toml"), REGISTRY, progress=False)
    points = session.fit.display.points
    assert np.abs(again.surface.evaluate(points) - session.fit.surface.evaluate(points)).max() <= 1e-9
    assert session.fit.result.report["boundary"]["loops"] == 2


def test_the_command_serves_until_it_is_interrupted(orbiframe, tmp_path, monkeypatch):
    """Nothing is changed, so that nothing is written."""
    from orbiframe_viewer import edit_command

    monkeypatch.chdir(tmp_path)
    opened: list[str] = []

    def interrupted(_: float) -> None:
        import urllib.request

        with urllib.request.urlopen(f"{opened[0]}state.json", timeout=10) as answer:
            assert json.loads(answer.read())["fitted"]
        raise KeyboardInterrupt

    monkeypatch.setattr(edit_command, "_open", opened.append)
    monkeypatch.setattr(edit_command.time, "sleep", interrupted)
    ran = orbiframe("edit", DATASETS / "torus.off", "--set", "basis.size=60", "--set", "fitter.name=least-squares")
    assert ran.status == 0, ran.err
    assert ran.out.splitlines()[0] == opened[0]
    assert ran.out.splitlines()[1] == "the page is served until Ctrl-C; it saves torus-edited.off"
    assert list(tmp_path.iterdir()) == []


def test_a_session_without_a_step_saves_what_makes_its_own_map(at_work, tmp_path):
    session = at_work(session_of(first("torus", 80), tmp_path / "torus.off"))
    sent(session, "save")
    settled(session)
    config = Config.load(tmp_path / "torus.toml")
    assert config.like is None
    found = fit(tmp_path / "torus.off", config, REGISTRY, progress=False)
    assert np.array_equal(found.surface.coefficients, session.fit.surface.coefficients)


def test_steps_are_taken_back_and_made_again(at_work, tmp_path):
    session = at_work(session_of(first("plate_genus2_coarse", 60), tmp_path / "plate.off"))
    start = session.history.now.vertices
    sent(session, "move", vertex=3, by=[0.1, 0, 0])
    sent(session, "move", vertex=4, by=[0, 0.1, 0])
    sent(session, "undo")
    assert session.state["redo"] == 1
    sent(session, "undo")
    sent(session, "undo")  # nothing is left
    assert np.array_equal(session.history.now.vertices, start)
    assert not session.state["unsaved"]
    sent(session, "redo")
    sent(session, "move", vertex=5, by=[0, 0, 0.1])
    assert (session.state["undo"], session.state["redo"]) == (2, 0)
    settled(session)
    moved = session.history.now.vertices - start
    assert np.array_equal(np.flatnonzero(np.abs(moved).max(axis=1)), [3, 5])


def test_control_points_that_are_moved_follow_functions_that_change_and_come_back(at_work, tmp_path):
    session = at_work(session_of(first("plate_genus2_coarse", 60), tmp_path / "plate.off"))
    sent(session, "move", control=7, by=[0.2, 0, 0])
    settled(session)
    moved = session.history.now.moved
    there = session.fit.shown(session.history.now)[0]
    place = there[session.fit.controls[7]]
    sent(session, "set", size=90)
    settled(session)
    ((number, *_),) = session.history.now.moved
    assert len(session.fit.controls) == 90
    other = session.fit.shown(session.history.now)[0][session.fit.controls[number]]
    assert np.linalg.norm(other - place) < 0.25 * session._scale
    sent(session, "undo")
    settled(session)
    assert session.history.now.moved == moved
    assert np.allclose(session.fit.shown(session.history.now)[0], there, atol=1e-9)


def test_a_fit_that_fails_is_told_and_the_picture_stays(at_work, tmp_path):
    session = at_work(session_of(first("plate_genus2_coarse", 60), tmp_path / "plate.off"))
    sent(session, "set", fairing=0.0)
    sent(session, "set", basis="tensor-bspline")  # of tori alone
    until = time.monotonic() + 60
    while not session.state["error"]:
        assert time.monotonic() < until
        time.sleep(0.02)
    assert "the picture is that of the linear fit before" in session.state["error"]
    assert session.asked("picture.bin", {}) is not None
    sent(session, "save")
    while session.state["saving"]:
        assert time.monotonic() < until
        time.sleep(0.02)
    sent(session, "undo")
    sent(session, "undo")
    settled(session)
    assert not (tmp_path / "plate.off").exists()


def test_where_the_map_serves_no_more_a_new_one_is_made_and_said(tmp_path):
    found = first("torus", 300, "fitter.name=least-squares")
    stretched = found.draft.vertices * [1, 1, 25]
    from dataclasses import replace

    draft = replace(found.draft, vertices=stretched)
    again = edited_fit(found.result.input, draft, base_of(300), REGISTRY, quiet, found)
    assert again.owns_map
    assert again.notes[0].startswith("a new map was made: the map of the surface does not serve this mesh: angles")


def test_a_saved_surface_is_edited_with_its_map_and_functions(tmp_path):
    whole = fit(DATASETS / "plate_genus2_coarse.off", size=70, basis="ps2", progress=False)
    save_surface(whole.surface, tmp_path / "plate.npz")
    surface = load_surface(tmp_path / "plate.npz", REGISTRY)
    own = surface.own_mesh
    mesh = own.with_vertices(surface.origin + surface.scale * own.vertices)
    base, found = first_fit(mesh, surface, Config.load(), REGISTRY, quiet)
    assert base.basis.name == "ps2"
    assert np.array_equal(found.surface.coefficients, whole.surface.coefficients)
    assert not found.owns_map


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (["absent.off"], 1, "there is no such file"),
        ([DATASETS / "torus.off", "--port", "99999"], 2, "cannot be served"),
        ([DATASETS / "torus.off", "-o", "absent/page.off"], 1, "there is no folder"),
        ([DATASETS / "torus.off", "-o", "torus.npz"], 2, "-o is the mesh"),
        ([DATASETS / "torus.off", "-o", DATASETS / "torus.off"], 2, "the input itself"),
        ([DATASETS / "torus.off", "--set", "basis.sise=3"], 2, "sise"),
    ],
)
def test_errors_say_what_to_do(orbiframe, tmp_path, monkeypatch, arguments, status, words):
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("edit", "--no-browser", *arguments)
    assert ran.status == status, ran.err
    assert words in ran.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.long
@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_what_is_not_saved_is_kept_when_the_command_ends(tmp_path):
    """By Ctrl-C and by a terminal that is closed: files of another name, which go on where one was."""
    import urllib.request

    words = [sys.executable, "-m", "orbiframe", "edit", "--no-browser", "--set", "basis.size=60"]
    for number, end in enumerate((signal.SIGINT, signal.SIGHUP, None), start=1):
        command = [*words, str(DATASETS / "plate_genus2_coarse.off")]
        process = subprocess.Popen(command, cwd=tmp_path, stdout=-1, stderr=-1, text=True, start_new_session=True)
        where = process.stdout.readline().strip()
        until = time.monotonic() + 100
        while not json.loads(urllib.request.urlopen(f"{where}state.json", timeout=10).read())["ready"]:
            assert time.monotonic() < until
            time.sleep(0.1)
        if end is not None:
            body = b'{"vertex": 2, "by": [0.5, 0, 0]}'
            urllib.request.urlopen(f"{where}move", body, timeout=10).read()
        process.send_signal(end or signal.SIGTERM)
        _, said = process.communicate(timeout=60)
        assert process.returncode == 0
        assert ("changes were not saved" in said) == (end is not None)
        if end is None:
            continue
        name = "plate_genus2_coarse-edited-unsaved" + ("" if number == 1 else f"-{number}")
        assert f"{name}.off" in said
        mesh, old = read(tmp_path / f"{name}.off"), read(DATASETS / "plate_genus2_coarse.off")
        assert mesh.vertices[2, 0] == old.vertices[2, 0] + 0.5
        Config.load(tmp_path / f"{name}.toml")


def test_a_session_ends_a_fit_that_is_wanted_no_more(tmp_path):
    session: EditSession = session_of(first("plate_genus2_coarse", 60), tmp_path / "plate.off")
    sent(session, "move", vertex=3, by=[0.1, 0, 0])
    thread = threading.Thread(target=session.work, daemon=True)
    thread.start()
    time.sleep(0.05)
    for step in range(10):
        sent(session, "move", vertex=3, by=[0.001 * step, 0, 0])
    settled(session)
    assert session.fit.draft is session.history.now
    session.end()
    thread.join(30)
    assert not thread.is_alive()


def test_the_command_reads_and_repairs_as_fit_does(orbiframe, tmp_path):
    """Two cubes that share a corner: the option that the sentence names is there."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    faces = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    second = np.where(faces == 0, 7, faces + 7)
    from orbiframe import Polyhedron, write

    mesh = Polyhedron.from_faces(np.concatenate([corners, corners[1:] + 1]), np.concatenate([faces, second]))
    path = Path(tmp_path / "pinched.off")
    write(path, mesh, REGISTRY)
    words = ("--set", "basis.size=60", "--set", "fitter.name=least-squares", "-o", tmp_path / "page.html")
    ran = orbiframe("view", path, *words)
    assert ran.status == 1
    assert "--split-nonmanifold-vertices" in ran.err
    ran = orbiframe("view", path, "--split-nonmanifold-vertices", *words)
    assert ran.status == 0, ran.err
    assert "split-nonmanifold-vertices:" in ran.err
