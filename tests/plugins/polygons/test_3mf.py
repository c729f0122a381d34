from __future__ import annotations

import tracemalloc
import warnings
import zipfile

import numpy as np
import pytest
from orbiframe_polygons.threemf_reader import MODEL, RELATIONS, read
from orbiframe_polygons.threemf_writer import RELATION, TYPES, write
from small_meshes import volume

from orbiframe import FormatError, Notice, Polyhedron
from orbiframe.testing import contract_tests

test_reader_laws = contract_tests("reader", read, suffix=".3mf", counterpart=write)
test_writer_laws = contract_tests("writer", write, suffix=".3mf", counterpart=read)

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TETRAHEDRON = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
OBJECT = (
    '<object id="1"><mesh><vertices>'
    + "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in CORNERS)
    + "</vertices><triangles>"
    + "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in TETRAHEDRON)
    + "</triangles></mesh></object>"
)
PLAIN = f'<?xml version="1.0"?>\n<model><resources>\n{OBJECT}</resources><build><item objectid="1"/></build></model>'


def of(tmp_path, model, name=MODEL):
    path = tmp_path / "mesh.3mf"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("[Content_Types].xml", TYPES)
        archive.writestr(RELATIONS, RELATION)
        archive.writestr(name, model)
    return path


def test_a_plain_model(tmp_path):
    found = read(of(tmp_path, PLAIN))
    assert found.vertices.tolist() == [list(p) for p in CORNERS]
    assert found.triangles.tolist() == TETRAHEDRON


def test_items_and_components_are_moved_to_their_places(tmp_path):
    pair = (
        '<object id="2"><components><component objectid="1"/>'
        '<component objectid="1" transform="2 0 0 0 2 0 0 0 2 10 0 0"/></components></object>'
    )
    model = PLAIN.replace("</resources>", pair + "</resources>").replace(
        'objectid="1"/></build>', 'objectid="2" transform="0 1 0 -1 0 0 0 0 1 0 0 5"/></build>'
    )
    found = read(of(tmp_path, model))
    assert found.triangles.tolist() == TETRAHEDRON + [[k + 4 for k in face] for face in TETRAHEDRON]
    # Rows times the matrix, as the format has it: x goes to y, and y to -x.
    first = np.array(CORNERS) @ [[0, 1, 0], [-1, 0, 0], [0, 0, 1]] + [0, 0, 5]
    second = (2 * np.array(CORNERS) + [10, 0, 0]) @ [[0, 1, 0], [-1, 0, 0], [0, 0, 1]] + [0, 0, 5]
    assert np.array_equal(found.vertices, np.vstack([first, second]))


def test_parts_that_repeat_again_and_again_are_refused(tmp_path):
    doubled = "".join(
        f'<object id="{k}"><components>' + f'<component objectid="{k - 1}"/>' * 2 + "</components></object>"
        for k in range(2, 32)
    )
    model = PLAIN.replace("</resources>", doubled + "</resources>").replace('item objectid="1"', 'item objectid="31"')
    with pytest.raises(FormatError, match="too often"):
        read(of(tmp_path, model))


def test_calls_without_points_are_counted_too(tmp_path):
    """2^30 calls in a kilobyte."""
    empty = '<object id="0"><mesh><vertices/><triangles/></mesh></object>'
    doubled = "".join(
        f'<object id="{k}"><components>' + f'<component objectid="{k - 1}"/>' * 2 + "</components></object>"
        for k in range(1, 31)
    )
    model = f'<model><resources>{empty}{doubled}</resources><build><item objectid="30"/></build></model>'
    with pytest.raises(FormatError, match="too often"):
        read(of(tmp_path, model))


def test_items_are_counted_before_they_are_made(tmp_path):
    vertices = '<vertex x="0" y="0" z="0"/>' * 20_000
    mesh = (
        f'<object id="1"><mesh><vertices>{vertices}</vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles>'
    )
    items = '<item objectid="1"/>' * 40_000
    model = f"<model><resources>{mesh}</mesh></object></resources><build>{items}</build></model>"
    path = of(tmp_path, model)
    tracemalloc.start()
    with pytest.raises(FormatError, match="too often"):
        read(path)
    assert tracemalloc.get_traced_memory()[1] < 2**26  # eight hundred million points would take 2^34
    tracemalloc.stop()


@pytest.mark.parametrize(("unit", "size"), [("inch", 25.4), ("micron", 0.001), ("meter", 1000), ("foot", 304.8)])
def test_a_unit_is_converted_to_millimetres_and_said(tmp_path, unit, size):
    with pytest.warns(Notice, match=rf"the unit is {unit}; coordinates are converted to millimetres \(times {size}\)"):
        found = read(of(tmp_path, PLAIN.replace("<model>", f'<model unit="{unit}">')))
    assert np.allclose(found.vertices, size * np.array(CORNERS))


def test_millimetres_are_no_news(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert read(of(tmp_path, PLAIN.replace("<model>", '<model unit="millimeter">'))).vertices.max() == 1


def test_a_mirroring_transform_turns_the_faces(tmp_path):
    mirror = 'transform="-1 0 0 0 1 0 0 0 1 0 0 0"'
    plain, turned = (
        read(of(tmp_path, PLAIN)),
        read(of(tmp_path, PLAIN.replace('item objectid="1"', f'item objectid="1" {mirror}'))),
    )
    assert volume(turned) == pytest.approx(volume(plain))
    pair = f'<object id="2"><components><component objectid="1" {mirror}/></components></object>'
    twice = PLAIN.replace("</resources>", pair + "</resources>").replace(
        'item objectid="1"', f'item objectid="2" {mirror}'
    )
    assert read(of(tmp_path, twice)).triangles.tolist() == TETRAHEDRON


def test_an_archive_that_swells_is_refused(tmp_path):
    with pytest.raises(FormatError, match="swells"):
        read(of(tmp_path, PLAIN.replace("<model>", "<model>" + " " * 50_000_000)))


@pytest.mark.parametrize(
    ("model", "place"),
    [
        ("", "no sound XML"),
        (PLAIN[:-9], "no sound XML"),
        (PLAIN.replace("<model>", "<!DOCTYPE a [<!ENTITY b SYSTEM '/etc/passwd'>]><model>"), "line 2.*entities"),
        (PLAIN.replace('<item objectid="1"/>', ""), "builds no object"),
        (PLAIN.replace('item objectid="1"', 'item objectid="7"'), "'7' is not there"),
        (
            PLAIN.replace('item objectid="1"', 'item objectid="1" p:path="/3D/other.model"'),
            "line 3.*another part|prefix",
        ),
        (PLAIN.replace("<model>", '<model unit="parsec">'), "line 2.*'parsec'"),
        (
            PLAIN.replace("<model>", '<model requiredextensions="b" xmlns:b="http://a/beamlattice/2017/02">'),
            "line 2.*requires the extension.*beamlattice",
        ),
        (PLAIN.replace("</resources>", OBJECT + "</resources>"), "second object '1'"),
        (PLAIN.replace('x="1"', 'x="nan"'), "line 3.*finite"),
        (PLAIN.replace('x="1"', 'x=""'), "line 3.*finite"),
        (PLAIN.replace('x="1"', 'x="1 1"'), "line 3.*finite"),
        (PLAIN.replace('x="1" y="0"', 'x="1 1" y=""'), "line 3.*finite"),
        (PLAIN.replace('x="1" y="0"', 'x="1&#9;1" y=" "'), "line 3.*finite"),
        (PLAIN.replace('x="1" y="0"', 'x="1-1" y=""'), "line 3.*finite"),
        (PLAIN.replace('x="1" y="0"', 'x="1;0" y="0"'), "line 3.*finite"),
        (PLAIN.replace('x="1" ', ""), "line 3.*lacks 'x'"),
        (PLAIN.replace('v1="1"', 'v1="4"'), "line 3.*vertex 4"),
        (PLAIN.replace('v1="1"', 'v1="1.5"'), "line 3.*1.5"),
        (PLAIN.replace('v1="1"', 'v1="-1"'), "line 3.*vertex -1"),
        (PLAIN.replace('"1"/></build>', '"1" transform="1 0 0"/></build>'), "3 numbers"),
        (PLAIN.replace("<mesh>", '<components><component objectid="1"/></components><mesh>'), "part of itself"),
    ],
)
def test_bad_models_are_refused(tmp_path, model, place):
    with pytest.raises(FormatError, match=f"mesh.3mf.*({place})"):
        read(of(tmp_path, model))


def test_what_is_no_archive_or_lacks_its_model_is_refused(tmp_path):
    with pytest.raises(FormatError, match=r"no part '3D/3dmodel\.model'"):
        read(of(tmp_path, PLAIN, name="other.model"))
    path = of(tmp_path, PLAIN)
    content = bytearray(path.read_bytes())
    content[content.index(MODEL.encode()) + 60] ^= 0xFF
    path.write_bytes(content)
    with pytest.raises(FormatError, match=r"mesh\.3mf"):
        read(path)


def test_larger_faces_are_refused(tmp_path):
    with pytest.raises(FormatError, match="face 0 has 4 corners"):
        write(tmp_path / "a.3mf", Polyhedron.from_faces(np.eye(4)[:, :3], [[0, 1, 2, 3]]))
