"""What the viewer shows: scenes of surfaces and fields, pages for notebooks, and errors of the command."""

from __future__ import annotations

import base64
import re
import threading
import urllib.request
from types import SimpleNamespace

import numpy as np
import pytest
from fitted import DATASETS, REGISTRY, fitted
from orbiframe_viewer import view_command
from orbiframe_viewer.scene import surface_scene
from orbiframe_viewer.shown_file import scenes_of

from orbiframe import Config, Polyhedron, fit, save_surface


def numbers(text: str, kind=np.float32) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype=kind)


@pytest.mark.parametrize("name", ["plate_genus2.off", "torus.off", "sphere.off", "projective_plane.off"])
def test_every_triangle_of_the_picture_has_its_place_on_the_surface_and_in_xh(name):
    found = fitted(name)
    surface, scene = found.surface, surface_scene(found.surface, found.input, name, faces=3000)
    index = numbers(scene["index"], np.uint32).reshape(-1, 3)
    place = surface.origin + surface.scale * numbers(scene["position"]).reshape(-1, 3)[index]
    flat = numbers(scene["xh"]["position"]).reshape(-1, 3, 3).astype(np.float64)
    assert len(flat) == len(index)
    geometry = surface.orbifold.geometry
    chart = flat[..., [2, 0, 1]] if geometry.curvature > 0 else geometry.from_chart("conformal", flat[..., :2])
    chosen = np.random.default_rng(1).choice(len(index), 40, replace=False)
    area = np.abs(geometry.triangle_area(chart[:, 0], chart[:, 1], chart[:, 2])).sum()
    assert area == pytest.approx(surface.orbifold.area, rel=1e-3)
    # A lift to the frame of patch 0 is a point of X/H, and the surface there is the point in space.
    from orbiframe import Points

    for corner in range(3):
        x = geometry.settle(chart[chosen, corner])
        points = surface.orbifold.settled(Points(np.zeros(len(chosen), dtype=np.intp), x))
        assert np.abs(surface.evaluate(points) - place[chosen, corner]).max() < 1e-3 * surface.scale


def test_of_a_mesh_with_a_boundary_its_own_faces_are_shown():
    """A box without its lid: nothing of what closes it for the map, in space, as input or in X/H."""
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    box = Polyhedron.from_faces(corners, [[0, 3, 2, 1], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
    found = fit(box, size=60, fast=True, boundary="auto", progress=False)
    for polyhedron, edges in ((found.input, 12), (None, 17)):
        scene = surface_scene(found.surface, polyhedron, "box", faces=2000)
        assert len(numbers(scene["edges"])) == edges * 8 * 2 * 3
        place = numbers(scene["position"]).reshape(-1, 3) * scene["scale"] + scene["origin"]
        assert place[:, 2].max() < 1.1
        assert len(numbers(scene["xh"]["position"])) == 3 * len(numbers(scene["index"]))
        assert numbers(scene["input"]["position"]).size == 10 * 9
        sides = {True: 20, False: 30}[polyhedron is not None]  # of five squares, or of ten triangles
        pieces, rest = divmod(numbers(scene["xh"]["edges"]).size, 6 * sides)
        assert (4 <= pieces <= 24, rest) == (True, 0)


def test_a_saved_surface_is_shown_as_it_is(tmp_path):
    found = fitted("torus.off")
    save_surface(found.surface, tmp_path / "torus.npz")
    (scene,), png = scenes_of(tmp_path / "torus.npz", Config.load(), REGISTRY, lambda *_: None)
    assert scene["name"] == "torus"
    assert scene["xh"]["geometry"] == "e2"
    assert {each["name"] for each in scene["values"]} == {"error", "distortion", "gaussian", "mean"}
    assert png.startswith(b"\x89PNG")


def test_a_field_is_shown_with_its_numbers(orbiframe, tmp_path):
    found = fitted("torus.off")
    save_surface(found.surface, tmp_path / "torus.npz")
    data, out = tmp_path / "heat.csv", tmp_path / "field.ply"
    points = found.input.vertices
    data.write_text("x,y,z,heat\n" + "".join(f"{x},{y},{z},{x + 2 * z}\n" for x, y, z in points))
    ran = orbiframe("field", tmp_path / "torus.npz", data, "-o", out, "--refine", "1")
    assert ran.status == 0, ran.err
    (scene,), _ = scenes_of(out, Config.load(), REGISTRY, lambda *_: None)
    (heat,) = [each for each in scene["values"] if each["name"] == "heat"]
    place = np.array(scene["origin"]) + scene["scale"] * numbers(scene["position"]).reshape(-1, 3)
    assert np.abs(numbers(heat["data"]) - (place[:, 0] + 2 * place[:, 2])).max() < 0.1
    assert (heat["kind"], scene["xh"]) == ("diverging", None)


def test_a_surface_shows_itself_in_notebooks_and_as_a_picture_without_javascript(tmp_path):
    shown = fitted("torus.off").surface.show()
    bundle = shown._repr_mimebundle_()
    assert set(bundle) == {"text/html", "image/png", "text/plain"}
    assert bundle["image/png"].startswith(b"\x89PNG")
    assert bundle["text/html"] == shown._repr_html_()
    frameless = re.sub("<iframe.*</iframe>", "", bundle["text/html"], flags=re.DOTALL)
    assert "<script" not in frameless
    assert 'src="data:image/png;base64,' in frameless
    shown.save(tmp_path / "torus.html")
    text = (tmp_path / "torus.html").read_text()
    assert text.count("<script") == text.count("</script>") == 4
    before, _, rest = text.partition("<noscript>")
    assert "<script" not in before
    assert 'src="data:image/png' in rest.partition("</noscript>")[0]


@pytest.mark.long
def test_a_notebook_frame_runs_in_a_browser(tmp_path, open_browser):
    from selenium.webdriver.support.ui import WebDriverWait

    page = tmp_path / "notebook.html"
    page.write_text(f"<!doctype html><meta charset=utf-8>{fitted('torus.off').surface.show()._repr_html_()}")
    driver = open_browser()
    driver.get(page.as_uri())
    # The frame lies over the picture, which is seen where the frame is taken out.
    seen = """const box = document.querySelector("img").getBoundingClientRect();
        return document.elementFromPoint(box.left + 5, box.top + 5).tagName"""
    assert driver.execute_script(seen) == "IFRAME"
    driver.switch_to.frame(0)
    state = "return document.body.dataset.state"
    WebDriverWait(driver, 30).until(lambda each: each.execute_script(state) == "ready")
    driver.switch_to.default_content()
    driver.execute_script("document.querySelector('iframe').remove()")
    assert driver.execute_script(seen) == "IMG"
    assert driver.execute_script("return document.querySelector('img').naturalWidth") > 100


def test_the_command_serves_until_it_is_interrupted(orbiframe, tmp_path, monkeypatch, capsys):
    save_surface(fitted("torus.off").surface, tmp_path / "torus.npz")
    opened: list[str] = []
    answers: list[int] = []

    def interrupted(_: float) -> None:
        with urllib.request.urlopen(f"{opened[0]}scenes.json", timeout=10) as answer:
            answers.append(answer.status)
        raise KeyboardInterrupt

    monkeypatch.setattr(view_command, "_open", opened.append)
    monkeypatch.setattr(view_command, "time", SimpleNamespace(sleep=interrupted))
    ran = orbiframe("view", tmp_path / "torus.npz")
    assert ran.status == 0, ran.err
    assert answers == [200]
    assert ran.out.splitlines()[0] == opened[0]
    assert opened[0].startswith("http://127.0.0.1:")
    assert threading.active_count() < 20


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (["absent.off"], 1, "there is no such file"),
        ([DATASETS / "torus.off", "-o", "page.txt"], 2, "give it this suffix"),
        ([DATASETS / "torus.off", "--port", "99999"], 2, "cannot be served"),
        ([DATASETS / "torus.off", "-o", "absent/page.html"], 1, "there is no folder"),
        ([DATASETS / "torus.off", "--set", "basis.sise=3", "-o", "page.html"], 2, "sise"),
    ],
)
def test_errors_say_what_to_do(orbiframe, tmp_path, monkeypatch, arguments, status, words):
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("view", *arguments)
    assert ran.status == status
    assert words in ran.err
    assert list(tmp_path.iterdir()) == []
