from __future__ import annotations

import numpy as np
import pytest
from orbiframe_polygons.collada.reader import read
from small_meshes import CUBE, QUADS, TRIANGLES, lists, volume, words
from written import written

from orbiframe import FormatError

POINTS = " ".join(words(CUBE))
POLYLIST = (
    '<polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 4 4 4 4 4</vcount>'
    f"<p>{' '.join(words(QUADS))}</p></polylist>"
)


def mesh(faces: str = POLYLIST, name: str = "g") -> str:
    return (
        f'<geometry id="{name}"><mesh><source id="{name}p"><float_array id="{name}a" count="24">{POINTS}</float_array>'
        f'<technique_common><accessor source="#{name}a" count="8" stride="3"><param name="X" type="float"/>'
        '<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>'
        f'<vertices id="{name}v"><input semantic="POSITION" source="#{name}p"/></vertices>{faces}</mesh></geometry>'
    )


NODE = '<node id="n"><instance_geometry url="#g"/></node>'


def scene(nodes: str = NODE, *, geometry: str | None = None, asset: str = "", more: str = "") -> str:
    return (
        f'<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">\n'
        f"<asset>{asset}</asset>{more}"
        f"<library_geometries>{mesh() if geometry is None else geometry}</library_geometries>"
        f'<library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>\n'
        '<scene><instance_visual_scene url="#s"/></scene></COLLADA>'
    )


def of(tmp_path, content: str):
    return written(tmp_path / "a.dae", content)


def primitive(name: str, lists_: list[str], count: int) -> str:
    inner = "".join(f"<p>{row}</p>" for row in lists_)
    return f'<{name} count="{count}"><input semantic="VERTEX" source="#gv" offset="0"/>{inner}</{name}>'


@pytest.mark.parametrize(
    ("faces", "wanted"),
    [
        (POLYLIST, QUADS),
        (primitive("polygons", words(QUADS), 6), QUADS),
        (primitive("triangles", [" ".join(words(TRIANGLES))], 12), TRIANGLES),
        (primitive("trifans", words(QUADS), 6), TRIANGLES),
    ],
)
def test_every_kind_of_face(tmp_path, faces, wanted):
    found = read(of(tmp_path, scene(geometry=mesh(faces))))
    assert found.vertices.tolist() == CUBE
    assert lists(found) == wanted


def test_strips_further_inputs_and_lines(tmp_path):
    strips = primitive("tristrips", words([[a, b, d, c] for a, b, c, d in QUADS]), 6)
    assert volume(read(of(tmp_path, scene(geometry=mesh(strips))))) == pytest.approx(1)
    doubled = POLYLIST.replace("<vcount>", '<input semantic="NORMAL" source="#x" offset="1"/><vcount>')
    pairs = " ".join(f"{w} 9" for row in words(QUADS) for w in row.split())
    assert lists(read(of(tmp_path, scene(geometry=mesh(doubled.replace(" ".join(words(QUADS)), pairs)))))) == QUADS
    with pytest.warns(UserWarning, match="1 primitives of lines"):
        read(of(tmp_path, scene(geometry=mesh(POLYLIST + primitive("lines", ["0 1"], 1)))))


@pytest.mark.parametrize(
    ("transform", "wanted", "size"),
    [
        ("<translate>1 2 3</translate>", [2, 2, 3], 1),
        ("<scale>-1 1 2</scale>", [-1, 0, 0], 2),
        ("<rotate>0 0 1 90</rotate>", [0, 1, 0], 1),
        ("<translate>1 0 0</translate><rotate>0 0 5 90</rotate><scale>2 1 1</scale>", [1, 2, 0], 2),
        ("<matrix>1 0 0 7 0 -1 0 8 0 0 1 9 0 0 0 1</matrix>", [8, 8, 9], 1),
    ],
)
def test_nodes_place_their_meshes_and_mirrors_turn_faces(tmp_path, transform, wanted, size):
    found = read(of(tmp_path, scene(NODE.replace("<instance", f"{transform}<instance"))))
    assert np.allclose(found.vertices[1], wanted)
    assert volume(found) == pytest.approx(size)


def test_nodes_in_nodes_and_copies(tmp_path):
    library = f'<library_nodes><node id="pair">{NODE.replace("n", "n", 1)}</node></library_nodes>'
    inner = '<node><instance_geometry url="#g"/></node>'
    nodes = f'<node><translate>5 0 0</translate><instance_node url="#pair"/>{inner}</node>'
    found = read(of(tmp_path, scene(nodes, more=library)))
    assert volume(found) == pytest.approx(2)
    assert found.vertices.min(axis=0).tolist() == [5, 0, 0]


def test_a_unit_is_converted_and_said(tmp_path):
    with pytest.warns(UserWarning, match=r"the unit is inch; .*metres \(times 0.0254\)"):
        found = read(of(tmp_path, scene(asset='<unit name="inch" meter="0.0254"/>')))
    assert found.vertices.max() == pytest.approx(0.0254)
    assert read(of(tmp_path, scene(asset='<unit name="meter" meter="1"/><up_axis>Z_UP</up_axis>'))).vertices.max() == 1


BOMB = (
    '<library_nodes><node id="b0"/>'
    + "".join(
        f'<node id="b{k}"><instance_node url="#b{k - 1}"/><instance_node url="#b{k - 1}"/></node>' for k in range(1, 40)
    )
    + "</library_nodes>"
)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "line 1.*no sound XML"),
        ("<Other/>", "0 elements 'COLLADA'"),
        (scene().replace("<COLLADA", "<!DOCTYPE a [<!ENTITY b 'c'>]><COLLADA"), "entities"),
        ("<COLLADA>" + "<a>" * 300 + "</a>" * 300 + "</COLLADA>", "nested"),
        (scene("<node/>"), "no triangles"),
        (scene(NODE.replace("#g", "other.dae#g")), "line 2: instance_geometry.*points to another file"),
        (scene(NODE.replace("#g", "#h")), "no geometry 'h'"),
        (scene(NODE.replace("instance_geometry", "instance_controller")), "bent by a controller"),
        (scene(NODE.replace("<inst", "<lookat>1 2 3 4 5 6 7 8 9</lookat><inst")), "lookat.*not read"),
        (scene(NODE.replace("<inst", "<skew>1 2 3 4 5 6 7</skew><inst")), "skew.*not read"),
        (scene(NODE.replace("<inst", "<scale>1 2</scale><inst")), "scale.*2 numbers, but 3"),
        (scene(NODE.replace("<inst", f"<matrix>{'1 ' * 16}</matrix><inst")), "affine"),
        (scene(NODE.replace("<inst", "<rotate>0 0 0 90</rotate><inst")), "length 0"),
        (scene('<node id="n"><instance_node url="#n"/></node>'), "nested too deeply"),
        (scene('<node><instance_node url="#b39"/></node>', more=BOMB), "too often"),
        (scene(asset='<unit meter="0"/>'), "meter is '0'"),
        (scene(asset='<unit meter="nan"/>'), "meter is 'nan'"),
        (scene().replace('count="24"', 'count="23"'), "23 numbers are declared, but 24"),
        (scene().replace('count="8"', 'count="9"'), "do not fit"),
        (scene().replace('stride="3"', 'stride="2"'), "do not fit"),
        (scene().replace('source="#ga" count', 'source="other.xml#a" count'), "another file"),
        (scene().replace('source="#gp"', 'source="#none"'), "no source 'none'"),
        (scene().replace('<polylist count="6"', '<polylist count="5"'), "5 polygons are declared"),
        (scene().replace("<vcount>4", "<vcount>5"), "vcount"),
        (scene().replace("<p>0 3 2 1", "<p>0 3 2 8"), "vertex 8"),
        (scene().replace("<p>0 3 2 1", "<p>0 3 2 1.5"), "1.5"),
        (scene().replace("<p>0", "<ph/><p>0"), "holes"),
        (scene().replace('semantic="VERTEX"', 'semantic="OTHER"'), "VERTEX is required"),
        (scene().replace("<mesh>", "<spline>").replace("</mesh>", "</spline>"), "no mesh in it"),
        (scene().replace("1 1 0 0 1 0", "1 1 0 0 nan 0"), "nan"),
        (scene(geometry=mesh() + mesh()), "'g' stands twice|'gp' stands twice"),
        (scene().replace('url="#s"', 'url="#t"'), "shows the scenes"),
    ],
)  # fmt: skip
def test_what_is_not_so_is_refused_with_its_place(tmp_path, content, said):
    with pytest.raises(FormatError, match=rf"(?s)a\.dae.*{said}"):
        read(of(tmp_path, content))
