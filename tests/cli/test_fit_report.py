"""The report of a fit as a page: whole, offline, with all that was promised, and a status that warns."""

from __future__ import annotations

import base64
import json
import shlex
from html.parser import HTMLParser

import numpy as np
import pytest

from orbiframe.meshes.polyhedron import Polyhedron
from orbiframe.surfaces.colour_scale import ColourScale
from orbiframe.surfaces.shaded_mesh import shaded_picture

SMALL = ("--size", 60, "--refine", 4)


class Page(HTMLParser):
    """The links, pictures and words of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.pictures: list[tuple[str, bytes]] = []
        self.words = ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        self.links += [found[name] for name in ("src", "href", "data", "action") if name in found]
        if tag == "img":
            self.pictures.append((found["alt"], base64.b64decode(found["src"].partition("base64,")[2])))

    def handle_data(self, data):
        self.words += data


def test_a_folder_gets_a_page_that_needs_nothing_else(orbiframe, cube, tmp_path):
    ran = orbiframe("fit", cube, "-o", tmp_path / "a.ply", "--report", tmp_path / "deep" / "report", *SMALL)
    assert ran.status == 0, ran.err
    folder = tmp_path / "deep" / "report"
    assert {path.name for path in folder.iterdir()} == {"index.html", "report.json"}
    text = (folder / "index.html").read_text()
    page, report = Page(text), json.loads((folder / "report.json").read_text())
    assert page.links
    assert all(link.startswith("data:") for link in page.links)
    assert "http" not in text.replace("http-equiv", "")
    names = [name for name, _ in page.pictures]
    assert names[:3] == ["the input", "the smooth surface", "the images of the edges on the surface"]
    assert len(names) == 3 + 4 + len(report["distance"]["worst"])
    assert all(png.startswith(b"\x89PNG") for _, png in page.pictures)
    assert len({png for _, png in page.pictures}) == len(names)
    assert f"{report['distance']['hausdorff']:.3e}" in page.words
    for words in ("Hausdorff", "normals turned", "self-intersecting", "Gaussian curvature", "digits lost", "numpy"):
        assert words in page.words
    assert "Nothing asks for a look" in page.words


def test_the_command_makes_the_same_report_again(orbiframe, cube, tmp_path):
    path = tmp_path / "my report.json"
    orbiframe("fit", cube, "-o", tmp_path / "a.ply", "--report", path, *SMALL)
    first = json.loads(path.read_text())
    path.unlink()
    program, *words = shlex.split(first["command"])
    assert program == "orbiframe"
    assert orbiframe(*words).status == 0
    again = json.loads(path.read_text())
    assert {**first, "seconds": 0} == {**again, "seconds": 0}


def test_places_of_the_largest_errors_are_apart_and_in_order(orbiframe, cube, tmp_path):
    path = tmp_path / "report.json"
    orbiframe("fit", cube, "-o", tmp_path / "a.ply", "--report", path, *SMALL)
    distance = json.loads(path.read_text())["distance"]
    worst, diagonal = distance["worst"], np.sqrt(3)
    assert 1 < len(worst) <= 6
    assert np.diff([each["distance"] for each in worst]).max() < 1e-9  # equal ones are in the order of the mesh
    largest = max(distance[key]["max"] for key in ("mesh_to_surface", "surface_to_mesh"))
    assert worst[0]["distance"] == pytest.approx(largest, rel=1e-9)
    places = np.array([each["place"] for each in worst])
    away = np.linalg.norm(places[:, None] - places, axis=2)
    assert away[~np.eye(len(places), dtype=bool)].min() > 0.08 * diagonal
    # A cube is missed most at its corners.
    assert np.abs(places - np.round(places)).max() < 1e-9


@pytest.mark.parametrize("name", ["report", "report.json"])
def test_who_asks_for_a_report_is_warned_by_the_status(orbiframe, tmp_path, name):
    mesh = tmp_path / "thin.off"
    mesh.write_text(_rod())
    arguments = ("fit", mesh, "-o", tmp_path / "a.ply", "--size", 30, "--refine", 1, "--fast")
    without = orbiframe(*arguments)
    assert without.status == 0
    assert "too few for the thin parts" in without.out
    ran = orbiframe(*arguments, "--report", tmp_path / name)
    assert ran.status == 3
    if name == "report":
        assert "too few for the thin parts" in Page((tmp_path / "report" / "index.html").read_text()).words


def _rod() -> str:
    """A box of 30 x 1 x 1, cut into 30 pieces."""
    points = [f"{x} {y} {z}" for x in range(31) for y, z in ((0, 0), (1, 0), (1, 1), (0, 1))]
    sides = [
        f"4 {4 * x + k} {4 * x + (k + 1) % 4} {4 * x + 4 + (k + 1) % 4} {4 * x + 4 + k}"
        for x in range(30)
        for k in range(4)
    ]
    ends = ["4 3 2 1 0", "4 120 121 122 123"]
    return "\n".join(["OFF", f"{len(points)} {len(sides) + 2} 0", *points, *sides, *ends]) + "\n"


@pytest.mark.parametrize(
    ("report", "words"), [("cube.off/report", "is a file; name a folder"), ("/dev/null", "is a device; name a folder")]
)
def test_a_folder_that_cannot_be_is_refused_before_the_work(orbiframe, cube, tmp_path, monkeypatch, report, words):
    monkeypatch.chdir(tmp_path)
    ran = orbiframe("fit", cube, "-o", "a.ply", "--report", report, *SMALL)
    assert ran.status == 1
    assert words in ran.err
    assert not (tmp_path / "a.ply").exists()


def test_several_surfaces_have_a_page_together(orbiframe, cube, tmp_path):
    mesh = tmp_path / "two.off"
    lines = cube.read_text().splitlines()[2:]
    points = [[float(x) for x in line.split()] for line in lines[:8]]
    faces = [[int(v) for v in line.split()][1:] for line in lines[8:]]
    points += [[x + 3, y, z] for x, y, z in points]
    faces += [[v + 8 for v in face] for face in faces]
    text = [" ".join(map(str, point)) for point in points] + [" ".join(map(str, [4, *face])) for face in faces]
    mesh.write_text("\n".join(["OFF", "16 12 0", *text]) + "\n")
    ran = orbiframe("fit", mesh, "-o", tmp_path / "a.ply", "--report", tmp_path / "report", "--refine", 1, "--fast")
    assert ran.status == 0, ran.err
    page = Page((tmp_path / "report" / "index.html").read_text())
    assert "Part 1 of 2" in page.words
    assert "Part 2 of 2" in page.words
    assert [name for name, _ in page.pictures].count("the smooth surface") == 2


def test_pictures_show_colours_and_only_the_lines_in_front():
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
    mesh = Polyhedron.from_corners(square, np.array([0, 3, 6]), np.array([0, 1, 2, 0, 2, 3]))
    red = np.tile([1.0, 0.0, 0.0], (4, 1))

    def pixels(height: float) -> np.ndarray:
        line = np.array([[-0.9, 0.0, height], [0.9, 0.0, height]])
        return shaded_picture(mesh, width=60, view=(0, 0, 1), colours=red, lines=[line]).pixels

    before, behind = pixels(0.5), pixels(-0.5)
    assert behind[30, 30, 0] > 200
    assert not behind[30, 30, 1:3].any()
    assert before[30, 30, 0] < 60
    assert (before[10] == behind[10]).all()


def test_colours_rise_with_the_numbers_and_what_is_no_number_is_grey():
    values = np.append(np.linspace(-2, 2, 101), np.nan)
    rising, diverging = ColourScale.rising(values), ColourScale.diverging(values)
    assert (rising.low, diverging.low) == (-2, -diverging.high)
    light = rising.colours(values) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(light[:-2]) > -1e-12).all()
    assert diverging.colours(np.array([0.0]))[0] == pytest.approx(np.array([214, 217, 220]) / 255)
    assert (rising.colours(values)[-1] == 0.6).all()
