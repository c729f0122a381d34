from __future__ import annotations

import numpy as np
import pytest
from orbiframe_polygons.xdmf_reader import read
from orbiframe_polygons.xdmf_writer import write
from written import written

from orbiframe import FormatError, Polyhedron
from orbiframe.testing import contract_tests

test_reader_laws = contract_tests("reader", read, suffix=".xdmf", counterpart=write)
test_writer_laws = contract_tests("writer", write, suffix=".xdmf", counterpart=read)

PLAIN = """<?xml version="1.0"?>
<Xdmf Version="3.0" xmlns:xi="http://www.w3.org/2001/XInclude"><Domain><Grid>
<Geometry GeometryType="XYZ"><DataItem Dimensions="4 3" Format="XML">
0 0 0  1 0 0
0 1 0  0 0 1
</DataItem></Geometry>
<Topology TopologyType="Triangle" NumberOfElements="4"><DataItem Format="XML" Dimensions="4 3">
0 2 1 0 1 3
1 2 3
2 0 3
</DataItem></Topology>
<Attribute Name="a" Center="Node"><DataItem Format="XML" Dimensions="4">1 2 3 4</DataItem></Attribute>
</Grid></Domain></Xdmf>
"""
MIXED = PLAIN.replace('"Triangle"', '"Mixed"').replace("0 2 1 0 1 3\n1 2 3\n2 0 3", "4 0 2 1 5 0 1 2 3\n3 4 3 2 1 0")
MIXED = MIXED.replace('NumberOfElements="4"', 'NumberOfElements="3"').replace('"4 3">\n4', '"15">\n4')


def of(tmp_path, content):
    return written(tmp_path / "mesh.xdmf", content)


def test_triangles_and_a_mixture(tmp_path):
    found = read(of(tmp_path, PLAIN))
    assert np.array_equal(found.vertices, np.vstack([np.zeros(3), np.eye(3)]))
    assert found.triangles.tolist() == [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    assert read(of(tmp_path, MIXED)).tail.tolist() == [0, 2, 1, 0, 1, 2, 3, 3, 2, 1, 0]


def test_a_base_offset_is_obeyed(tmp_path):
    content = PLAIN.replace("0 2 1 0 1 3\n1 2 3\n2 0 3", "1 3 2 1 2 4\n2 3 4\n3 1 4")
    found = read(of(tmp_path, content.replace('NumberOfElements="4"', 'BaseOffset="1"')))
    assert found.triangles.tolist() == [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def test_a_document_type_without_entities_is_passed_over(tmp_path):
    head = '<?xml version="1.0"?>\n<!DOCTYPE Xdmf SYSTEM "Xdmf.dtd" []>'
    found = read(of(tmp_path, PLAIN.replace('<?xml version="1.0"?>', head)))
    assert len(found.triangles) == 4


def test_polygons_of_one_size(tmp_path):
    made = Polyhedron.from_faces(np.random.default_rng(1).normal(size=(6, 3)), [[0, 1, 2, 3, 4], [5, 4, 3, 2, 1]])
    write(tmp_path / "a.xdmf", made)
    assert np.array_equal(read(tmp_path / "a.xdmf").tail, made.tail)


@pytest.mark.parametrize(
    ("content", "place"),
    [
        ("", "line 1.*no sound XML"),
        ("<Xdmf/>", "no Geometry"),
        (PLAIN[:-9], "no sound XML"),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]>" + PLAIN.split("\n", 1)[1], "line 1.*entities"),
        (PLAIN.replace('"4 3" Format="XML"', '"4 3" Format="HDF"', 1), "line 3.*another file"),
        (PLAIN.replace('Format="XML"', 'Format="Binary"', 1), "line 3.*another file"),
        (PLAIN.replace("<Attribute", '<xi:include href="/etc/passwd"/><Attribute'), "line 12.*another file"),
        (PLAIN.replace('Format="XML"', 'Format="XML" Reference="/Xdmf"', 1), "line 3.*references"),
        (PLAIN.replace("</Domain>", PLAIN[PLAIN.index("<Grid") : PLAIN.index("</Domain>")] + "</Domain>"), "second"),
        (PLAIN.replace("0 1 0  0 0 1", "0 1 0  0 nan 1"), "line 5.*nan"),
        (PLAIN.replace("0 1 0  0 0 1", "0 1 0  0 0"), "11 numbers"),
        (PLAIN.replace("1 2 3\n2", "1 2 4\n2"), "names vertex 4"),
        (PLAIN.replace("1 2 3\n2", "1 2.5 3\n2"), "line 9.*2.5"),
        (PLAIN.replace("Triangle", "Tetrahedron"), "tetrahedron"),
        (PLAIN.replace('"4 3" Format', '"12 3" Format', 1), "line 3.*12 3"),
        (PLAIN.replace('"4 3" Format', '"3 4" Format', 1), "line 3.*3 4"),
        (PLAIN.replace('"XML" Dimensions="4 3"', '"XML" Dimensions="5 3"'), "line 7.*5 3"),
        (PLAIN.replace('NumberOfElements="4"', 'NumberOfElements="3"'), "NumberOfElements='3'.*4 faces"),
        (PLAIN.replace('NumberOfElements="4"', 'Dimensions="5"'), "Dimensions='5'.*4 faces"),
        (PLAIN.replace('NumberOfElements="4"', 'NumberOfElements="\u00b2"'), "whole number"),
        (PLAIN.replace('NumberOfElements="4"', 'BaseOffset="1"'), "vertex -1"),
        (PLAIN.replace('NumberOfElements="4"', 'BaseOffset="-1"'), "BaseOffset='-1'"),
        (PLAIN.replace('NumberOfElements="4"', 'NodesPerElement="4"'), "topology"),
        (PLAIN.replace('NumberOfElements="4"', 'Order="0 2 1"'), "Order"),
        (PLAIN.replace('"XYZ"', '"X_Y_Z"'), "X_Y_Z"),
        (PLAIN.replace("<DataItem Dim", '<DataItem ItemType="HyperSlab" Dim', 1), "line 3.*HyperSlab"),
        (PLAIN.replace("<DataItem Dim", '<DataItem Seek="8" Dim', 1), "line 3.*Seek"),
        (PLAIN.replace("<Grid>", '<Grid GridType="SubSet">'), "line 2.*SubSet"),
        (MIXED.replace("4 0 2 1", "6 0 2 1"), "line 8.*code 6"),
        (MIXED.replace("3 4 3 2 1 0", "3 9 3 2 1 0"), "line 9.*code 3"),
        (MIXED.replace("3 4 3 2 1 0", "3 2 3 2"), "line 9.*2 corners"),
    ],
)
def test_bad_files_are_refused_with_their_place(tmp_path, content, place):
    with pytest.raises(FormatError, match=f"mesh.xdmf.*({place})"):
        read(of(tmp_path, content))
