"""Pictures: the geometry of what is drawn, not its pixels."""

from __future__ import annotations

import io
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from orbiframe_drawing.colours import channels, diverging, line_colour, tint
from orbiframe_drawing.file import save_picture
from orbiframe_drawing.group_picture import draw_group, group_picture
from orbiframe_drawing.models import model_of
from orbiframe_drawing.page import Page
from orbiframe_drawing.picture import Curve, Label, Picture, Raster, Shape, beside, chained, circle, polygon
from orbiframe_drawing.polygon import polygon_of
from orbiframe_drawing.svg import svg_text
from orbiframe_drawing.tiles import nearest_tiles, tiles_within
from reference_geometries import GEOMETRIES

from orbiframe import FormatError, GeometryError, PluginError, Registry, UsageError, Word
from orbiframe.groups import orbifold_group
from orbiframe.words import ConwaySymbol

S2, E2, H2 = GEOMETRIES
GEOMETRY = {1: S2, 0: E2, -1: H2}
NAMES = {1: "finite", 0: "lattice", -1: "regular-polygon"}
REGISTRY = Registry.discover()


def group_of(text):
    word = Word.parse(text)
    sign = int(np.sign(word.euler_characteristic))
    return REGISTRY.load("group", NAMES[sign])(GEOMETRY[sign], word)


def nearest(group, count):
    return nearest_tiles(group, polygon_of(group), count)


def points(geometry, seed, count=6, reach=2.0):
    rng = np.random.default_rng(seed)
    limit = min(reach, 1.4) if geometry.curvature > 0 else reach
    return geometry.from_polar(rng.uniform(0.05, limit, count), rng.uniform(-np.pi, np.pi, count))


# ---- models ---------------------------------------------------------------------------------------------------------


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.1, 5.0))
def test_conformal_geodesics_are_arcs_that_meet_the_unit_circle_at_right_angles(seed, reach):
    x = points(H2, seed, reach=reach)
    for arc in model_of(H2).geodesics(x[:3], x[3:]):
        if arc.turn:
            # Circles with centres c, 0 and radii r, 1 are orthogonal if and only if |c|^2 = r^2 + 1.
            assert arc.centre @ arc.centre == pytest.approx(arc.radius**2 + 1, rel=1e-6)


@pytest.mark.parametrize("geometry", GEOMETRIES, ids=lambda g: g.name)
@pytest.mark.parametrize("name", ["projective", "conformal", "hyperboloid", "sphere"])
@pytest.mark.parametrize("seed", range(4))
def test_points_of_a_curve_are_points_of_the_geodesic(geometry, name, seed):
    """Against the exponential map, in every model that a geometry has."""
    own = {-1: "hyperboloid", 1: "sphere"}.get(geometry.curvature)
    if name not in ("projective", "conformal", own):
        with pytest.raises(UsageError, match="models are projective, conformal"):
            model_of(geometry, name)
        return
    model, x = model_of(geometry, name), points(geometry, seed, reach=1.5)
    for curve, start, end in zip(model.geodesics(x[:3], x[3:]), x[:3], x[3:], strict=True):
        exact = model.place(geometry.exp(start, np.linspace(0, 1, 401)[:, None] * geometry.log(start, end)))
        drawn = curve.at(np.linspace(0, 1, 9))
        gap = np.linalg.norm(drawn[:, None] - exact, axis=2).min(axis=1)
        spacing = np.linalg.norm(np.diff(exact, axis=0), axis=1).max()
        assert gap.max() < spacing + 2e-3 * (own == name)
        assert drawn[[0, -1]] == pytest.approx(model.place(np.stack([start, end])), abs=1e-12)


@pytest.mark.parametrize(("geometry", "name"), [(H2, "hyperboloid"), (S2, "sphere"), (H2, "conformal"), (E2, None)])
def test_what_is_seen_at_the_place_of_a_point_is_the_point(geometry, name):
    model = model_of(geometry, name)
    x = points(geometry, 3, 20, reach=1.0)
    if geometry.curvature > 0:
        x = x[[len(model.front(p[None], False)) > 0 for p in x]]
        assert len(x) > 3
    assert model.points(model.place(x)) == pytest.approx(x, abs=1e-9)


def test_outside_of_a_model_nothing_is_seen():
    for model in (model_of(H2), model_of(S2)):
        assert np.isnan(model.points(np.array([[0.9, 0.9]]))).all()


def test_the_sphere_hides_what_is_behind():
    """The drawn part of a hemisphere has the area of the disc cut by half an ellipse."""
    model = model_of(S2)
    corners = polygon_of(group_of("aa")).corners
    (path,) = model.paths(corners[None])
    outline = np.concatenate([curve.at(np.linspace(0, 1, 200)[:-1]) for curve in path])
    x, y = outline.T
    area = abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2
    # The equator appears as an ellipse with half axes 1 and the sine of the elevation; its near half is drawn.
    assert area == pytest.approx(np.pi / 2 * (1 + np.sin(model.elevation)), rel=1e-3)
    hidden = model.paths(-corners[None])
    far = np.concatenate([curve.at(np.linspace(0, 1, 200)[:-1]) for curve in hidden[0]])
    rest = abs(np.sum(far[:, 0] * np.roll(far[:, 1], -1) - far[:, 1] * np.roll(far[:, 0], -1))) / 2
    assert area + rest == pytest.approx(np.pi, rel=1e-3)


@pytest.mark.parametrize("tilt", [0.1, 0.4, 0.7, 1.0, 1.3])
def test_of_a_turned_hemisphere_half_a_disc_and_half_an_ellipse_are_seen(tilt):
    """Its border meets the outline in opposite points, between which no geodesic is the shortest."""
    model, angles = model_of(S2), 2 * np.pi * np.arange(40) / 40
    corners = S2.from_polar(np.pi / 2, angles) @ S2.translation(tilt, 0.3).T
    pole = S2.translation(tilt, 0.3)[:, 0]
    eye = np.array([np.sin(model.elevation), 0.0, -np.cos(model.elevation)])
    (path,) = model.paths(corners[None])
    x, y = np.concatenate([curve.at(np.linspace(0, 1, 100)[:-1]) for curve in path]).T
    area = abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2
    assert area == pytest.approx(np.pi / 2 * (1 + pole @ eye), rel=1e-3)


# ---- tiles ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("text", "sides"), [("abABcdCD", 8), ("aabbcc", 6), ("abAB", 4)])
def test_word_lengths_are_the_growth_of_the_tiling(text, sides):
    """1 tile, then one behind each side, then those next to them (spheres of the dual graph)."""
    tiles = nearest(group_of(text), 300)
    counts = np.bincount(tiles.length)
    # In {l, l} with l > 4 every tile of the first sphere has l - 1 new neighbours and none of them is shared.
    assert counts[:2].tolist() == [1, sides]
    assert tiles.first[1:].any(axis=1).all()
    assert not tiles.first[0].any()
    ones = tiles.length == 1
    assert (tiles.first[ones].sum(axis=1) == 1).all()
    assert tiles.first[ones].any(axis=0).all()


def test_lengths_in_the_square_lattice_are_sums_of_steps():
    tiles = tiles_within(group_of("abAB"), polygon_of(group_of("abAB")), 3.2)
    steps = np.abs(np.round(tiles.elements[:, 1:, 0])).sum(axis=1)
    # Near the border of the disc the way may lead out of it, never where both neighbours are within.
    assert (tiles.length == steps).all()
    corners = np.abs(tiles.elements[:, 1:, 0]).min(axis=1) > 0.5
    assert (tiles.first.sum(axis=1)[corners] == 2).all()


@pytest.mark.parametrize(
    ("text", "options", "count"),
    [
        ("abABcdCD", {"tiles": 60}, 49),  # 1, 8, 16, 16, 8 by distance of centres
        ("abABcdCD", {"tiles": 9}, 9),
        ("aabbcc", {"tiles": 30}, 25),
    ],
)
def test_tiles_of_one_distance_come_together(text, options, count):
    picture = group_picture(group_of(text), motif=False, **options)
    drawn = sum(len(s.paths) for s in picture.shapes if s.clip)
    assert drawn == count


@pytest.mark.parametrize("text", ["abABcdCD", "aabb", "abaB"])
@pytest.mark.parametrize("model", ["projective", "conformal"])
def test_all_tiles_that_meet_a_disc_are_drawn(text, model):
    group = group_of(text)
    picture = group_picture(group, model=model, radius=2.5, motif=False)
    assert sum(len(s.paths) for s in picture.shapes if s.clip) == len(group.tiles(2.5))


def test_filled_tiles_do_not_overlap_and_leave_no_gap():
    """Every point of a grid near the middle lies in exactly one tile: crossings of a ray with the drawn arcs."""
    group = group_of("abABcdCD")
    picture = group_picture(group, motif=False)
    outlines = [path for s in picture.shapes if s.clip for path in s.paths]
    rng = np.random.default_rng(0)
    place = rng.uniform(-100, 100, (40, 2))
    inside = np.zeros(40, dtype=int)
    for path in outlines:
        at = np.concatenate([curve.at(np.linspace(0, 1, 60)[:-1]) for curve in path])
        inside += [_winding(at - p) for p in place]
    assert (inside == 1).all()


def _winding(polygon_):
    angles = np.unwrap(np.arctan2(*np.append(polygon_, polygon_[:1], axis=0).T[::-1]))
    return abs(round((angles[-1] - angles[0]) / (2 * np.pi)))


def test_too_many_tiles_and_contradictions_are_refused():
    group = group_of("abABcdCD")
    with pytest.raises(UsageError, match="at most 20000"):
        group_picture(group, radius=30.0)
    with pytest.raises(UsageError, match="1 to 20000"):
        group_picture(group, tiles=0)
    with pytest.raises(UsageError, match="not negative"):
        group_picture(group, radius=-1.0)
    with pytest.raises(UsageError, match="give one of them"):
        group_picture(group, radius=1.0, tiles=3)
    with pytest.raises(UsageError, match="no model 'poincare'"):
        group_picture(group, model="poincare")
    with pytest.raises(GeometryError, match="whole sphere"):
        group_picture(group_of("aA"))


# ---- labels, sides and colours --------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["abABcdCD", "aabbccdd", "abaB", "aa", "abcdABCD"])
def test_every_side_has_its_letter_and_glued_sides_one_colour(text):
    picture = group_picture(group_of(text), tiles=1, model=None if text == "aa" else "conformal")
    letters = [label.text for label in picture.labels]
    # Of the projective plane one side is behind the sphere.
    assert letters == (["a"] if text == "aa" else [letter.lower() for letter in text])
    for label in picture.labels:
        assert label.colour == line_colour(ord(label.text) - ord("a") + 1)


def test_arrows_are_laid_upon_one_another_by_the_pairings():
    """The arrows of a side and of its mate run the same way after the pairing, for both signs of letters."""
    for text in ("abABcdCD", "aabbcc", "abaB"):
        group = group_of(text)
        word, polygon = group.word, polygon_of(group)
        for side, mate in enumerate(word.mate):
            ends = [polygon.sides[k, 0][:: int(np.sign(word.letters[k]))] for k in (side, mate)]
            moved = group.geometry.act(group.polygon.pairings[side], ends[1])
            assert moved == pytest.approx(ends[0], abs=1e-8)


def test_arrows_point_along_the_letters():
    picture = group_picture(group_of("abAB"), tiles=1)
    arrows = [s.paths[0] for s in picture.shapes if s.closed and s.fill == line_colour(1) and len(s.paths[0]) == 4]
    tips = [path[0].points[0] - path[2].points[0] for path in arrows]
    # Side a runs to the right below, side A is glued to it above: its arrow points to the right as well.
    assert len(tips) == 2
    assert all(tip[0] > 0 and abs(tip[1]) < 1e-9 for tip in tips)


def test_a_motif_shows_which_elements_reverse_orientation():
    group = group_of("abaB")
    picture = group_picture(group, tiles=9)
    (motif,) = [s for s in picture.shapes if s.opacity < 1]
    area = []
    for path in motif.paths:
        x, y = np.array([curve.points[0] for curve in path]).T
        area.append(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    parity = group.geometry.parity(nearest(group, 9).elements)
    assert np.sign(area).tolist() == (parity * np.sign(area[0])).tolist()
    assert set(parity) == {-1.0, 1.0}


def test_mirrors_have_no_arrows():
    signature = ConwaySymbol.parse("*237")
    picture = group_picture(orbifold_group(H2, signature), tiles=30)
    assert not [s for s in picture.shapes if s.fill in (line_colour(1), line_colour(2), line_colour(3))]
    assert [label.text for label in picture.labels] == ["a", "b", "c"]


def test_lines_are_thinner_farther_away():
    shapes = [s for s in group_picture(group_of("abABcdCD"), tiles=200).shapes if s.clip]
    first = next(s for s in shapes if s.fill == "#fbf6e9")
    assert first.width == max(s.width for s in shapes)
    assert min(s.width for s in shapes) < first.width / 3


def lightness(colour):
    """CIE L* of an sRGB colour."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in np.array(channels(colour)) / 255]
    y = np.dot([0.2126, 0.7152, 0.0722], linear)
    return 116 * np.cbrt(y) - 16 if y > 0.008856 else 903.3 * y


def test_the_first_letters_can_be_told_apart_in_grey_and_lines_are_dark_on_white():
    grey = [lightness(line_colour(k)) for k in range(1, 11)]
    assert max(grey) < 70
    assert min(abs(a - b) for k, a in enumerate(grey[:4]) for b in grey[:k]) > 4
    assert abs(lightness(tint(line_colour(1), 0.30)) - lightness(tint(line_colour(1), 0.52))) > 8


def test_the_first_letters_can_be_told_apart_by_the_colour_blind():
    """Linear sRGB seen by protanopes and deuteranopes, after Machado, Oliveira and Fernandes (2009)."""
    protan = [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    deutan = [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    rgb = np.array([channels(line_colour(k)) for k in range(1, 5)]) / 255
    for matrix in (protan, deutan):
        seen = np.clip(rgb**2.2 @ np.array(matrix).T, 0, 1) ** (1 / 2.2)
        gaps = [np.linalg.norm(a - b) for k, a in enumerate(seen) for b in seen[:k]]
        assert min(gaps) > 0.2


def test_colours_of_values_are_white_at_zero_and_differ_by_sign():
    colours = diverging(np.array([-1.0, 0.0, 1.0]))
    assert colours[1].tolist() == [255, 255, 255]
    assert colours[0][2] > colours[0][0]
    assert colours[2][0] > colours[2][2]


ORDERS = {"*": 2, "x": 2, "22": 2, "*33": 6, "3x": 6, "2*": 4, "222": 4, "*222": 8, "332": 12, "*532": 120, "3*2": 24}


@pytest.mark.parametrize("text", ORDERS)
def test_cells_of_spherical_groups_have_the_area_of_the_sphere_over_the_order(text):
    group = orbifold_group(S2, ConwaySymbol.parse(text))
    polygon = polygon_of(group)
    fan = S2.triangle_area(S2.origin, polygon.corners, np.roll(polygon.corners, -1, axis=0))
    assert fan.sum() == pytest.approx(4 * np.pi / ORDERS[text], rel=1e-9)
    tiles = nearest_tiles(group, polygon, 200)
    assert len(tiles.elements) == ORDERS[text]
    assert (tiles.length >= 0).all()
    # Across a side lies the tile of its neighbour: the side is nearer to no other.
    distance = S2.distance(polygon.middles, S2.origin)
    assert S2.distance(polygon.middles, polygon.neighbours[:, :, 0]) == pytest.approx(distance, abs=1e-7)
    assert group_picture(group).shapes


# ---- functions and points -------------------------------------------------------------------------------------------


def test_a_function_is_drawn_in_the_colours_of_its_values():
    picture = group_picture(group_of("abAB"), function=lambda x: np.sin(2 * np.pi * x[:, 1]))
    (raster,) = [item for item in picture.items if isinstance(item, Raster)]
    size = raster.colours.shape[0]
    page = Page(model_of(E2), 2.2 * np.sqrt(0.5))
    for x, channel in ((0.25, 0), (-0.25, 2), (1.25, 0)):
        column, row = ((1 + page.place(np.array([1.0, x, 0.0])) / 200 * [1, -1]) * size / 2).astype(int)
        colour = raster.colours[row, column].astype(int)
        assert colour[channel] > colour[2 - channel] + 60
        assert colour[3] == 255


def test_the_corners_outside_the_disc_are_transparent():
    picture = group_picture(group_of("abABcdCD"), function=lambda x: x[:, 1], tiles=1)
    (raster,) = [item for item in picture.items if isinstance(item, Raster)]
    assert raster.colours[0, 0, 3] == 0
    assert raster.colours[280, 280, 3] == 255


def test_points_are_drawn_in_every_tile():
    group = group_of("abABcdCD")
    picture = group_picture(group, tiles=9, points=points(H2, 0, 3, 0.5))
    dots = [s for s in picture.shapes if s.clip][-1]
    assert len(dots.paths) == 27


# ---- pictures and files ---------------------------------------------------------------------------------------------

ARC = Curve(np.array([(0.0, 0.0), (2.0, 0.0)]), np.pi)


def test_an_arc_knows_its_circle():
    assert ARC.centre == pytest.approx([1.0, 0.0])
    assert ARC.radius == pytest.approx(1.0)
    # Counterclockwise from (0, 0) about (1, 0): first down.
    assert ARC.at([0.5])[0] == pytest.approx([1.0, -1.0])
    assert ARC.reversed.at([0.5])[0] == pytest.approx([1.0, -1.0])


def test_chains_keep_every_curve_and_join_ends():
    square = polygon([(0, 0), (1, 0), (1, 1), (0, 1)])
    paths = chained([square[2], square[0].reversed, square[3], square[1]])
    assert [len(path) for path in paths] == [4]
    for before, after in zip(paths[0], paths[0][1:], strict=False):
        assert before.points[-1] == pytest.approx(after.points[0])


def test_pictures_beside_one_another_do_not_overlap():
    parts = [Picture((Label("a", np.zeros(2)),), (-10.0, -10.0, 10.0, 10.0 + k)) for k in (0, 20)]
    both = beside(parts, gap=5.0)
    assert both.size == (45.0, 40.0)
    assert both.labels[1].place[0] - both.labels[0].place[0] == pytest.approx(25.0)


def test_svg_is_xml_with_true_arcs_of_the_right_circle():
    picture = Picture((Shape([[ARC]], stroke="#000000"), Shape([circle((1, 1), 1)], True)), (0.0, -2.0, 3.0, 2.0))
    root = ElementTree.fromstring(svg_text(picture))
    data = [path.get("d") for path in root.iter("{http://www.w3.org/2000/svg}path")]
    # Counterclockwise in the plane is sweep flag 0 on a page whose second axis goes down.
    assert re.fullmatch(r"M0 2a1 1 0 0 0 2 0", data[0])
    assert data[1].count("a1 1 0 0 0") == 2


@pytest.mark.parametrize("turn", [1.0, -1.0, 4.0, -4.0])
def test_arcs_in_svg_run_through_the_middle_of_the_curve(turn):
    """Read as the standard says: of the two circles through the ends the flags choose one, and one of its arcs."""
    curve = Curve(np.array([(0.3, 0.1), (2.0, 1.0)]), turn)
    root = ElementTree.fromstring(svg_text(Picture((Shape([[curve]], stroke="#000000"),), (-9.0, -9.0, 9.0, 9.0))))
    data = root.find("{http://www.w3.org/2000/svg}path").get("d")
    x, y, radius, _, _, large, sweep, dx, dy = map(float, re.findall(r"-?\d*\.?\d+", data))
    half, chord = np.array([dx, dy]) / 2, np.hypot(dx, dy)
    # On the page, whose second axis goes down, sweep 1 turns clockwise as seen, from the first axis to the second.
    offset = np.sqrt(max(radius**2 - chord**2 / 4, 0)) * np.array([-dy, dx]) / chord
    centre = half + (offset if large != sweep else -offset)
    away = (half - centre) / np.linalg.norm(half - centre) if large == 0 else (centre - half) / np.linalg.norm(offset)
    middle = np.array([x, y]) + centre + radius * away
    wanted = curve.at([0.5])[0]
    assert middle - 9.0 == pytest.approx(wanted * [1, -1], abs=0.03)


@pytest.mark.parametrize("text", ["abABcdCD", "aabb", "aa"])
def test_the_same_picture_gives_the_same_bytes_in_every_format(text, tmp_path):
    group = group_of(text)
    for suffix in (".svg", ".png", ".pdf"):
        for name in ("one", "two"):
            draw_group(tmp_path / f"{name}{suffix}", group, tiles=2)
        assert (tmp_path / f"one{suffix}").read_bytes() == (tmp_path / f"two{suffix}").read_bytes()
    ElementTree.parse(tmp_path / "one.svg")
    assert (tmp_path / "one.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "one.pdf").read_bytes().startswith(b"%PDF")
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted(
        f"{n}{s}" for n in ("one", "two") for s in (".svg", ".png", ".pdf")
    )


def test_an_image_in_svg_is_the_image():
    from orbiframe_drawing.svg import _png
    from PIL import Image

    colours = np.random.default_rng(0).integers(0, 256, (7, 5, 4), dtype=np.uint8)
    assert (np.asarray(Image.open(io.BytesIO(_png(colours)))) == colours).all()


def test_png_shows_what_is_drawn(tmp_path):
    from PIL import Image

    items = (
        Shape([circle((0, 0), 40)], True, fill="#0072b2"),
        Raster(np.full((2, 2, 4), 200, np.uint8), (50, 50, 60, 60)),
    )
    save_picture(Picture(items, (-100.0, -100.0, 100.0, 100.0)), tmp_path / "disc.png")
    image = np.asarray(Image.open(tmp_path / "disc.png").convert("RGB")).astype(int)
    blue = (np.abs(image - channels("#0072b2")).max(axis=2) < 12).mean()
    assert blue == pytest.approx(np.pi * 40**2 / 200**2, rel=0.02)


def test_wrong_files_are_refused(tmp_path):
    picture = Picture((), (0.0, 0.0, 10.0, 10.0))
    with pytest.raises(UsageError, match=r"\.svg, \.png"):
        save_picture(picture, tmp_path / "picture.gif")
    with pytest.raises(FormatError, match="no folder"):
        save_picture(picture, tmp_path / "none" / "picture.svg")


def test_a_missing_library_is_named_with_the_command_that_installs_it(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
    with pytest.raises(PluginError, match=r"pip install 'orbiframe\[pictures\]'"):
        save_picture(Picture((), (0.0, 0.0, 10.0, 10.0)), tmp_path / "picture.png")
    save_picture(Picture((), (0.0, 0.0, 10.0, 10.0)), tmp_path / "picture.svg")
    assert [file.name for file in tmp_path.iterdir()] == ["picture.svg"]
