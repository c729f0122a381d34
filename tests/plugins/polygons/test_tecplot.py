from __future__ import annotations

import pytest
from orbiframe_polygons.elements.tecplot_reader import read
from small_meshes import CUBE, QUADS, TRIANGLES, lists, words
from written import written

from orbiframe import FormatError

HEAD = 'TITLE = "a cube"\nVARIABLES = "X", "Y", "Z"\n'
ZONE = 'ZONE T="all, of = it" N=8, E=6, F=FEPOINT, ET=QUADRILATERAL\n'
BODY = "\n".join(words(CUBE)) + "\n" + "\n".join(words(QUADS, first=1)) + "\n"
PLAIN = HEAD + ZONE + BODY
BLOCK = "\n".join(" ".join(str(p[k]) for p in CUBE) for k in range(3)) + "\n" + "\n".join(words(QUADS, first=1))


def of(tmp_path, content: str):
    return written(tmp_path / "a.dat", content)


@pytest.mark.parametrize(
    "content",
    [
        PLAIN,
        PLAIN.replace("\n", "\r\n"),
        PLAIN.lower(),
        HEAD.replace('"X", "Y", "Z"', "X, Y, Z") + ZONE + BODY,
        "variables = x y z\nzone n=8 e=6 f=fepoint et=quadrilateral\n" + BODY,
        HEAD + "ZONE NODES=8, ELEMENTS=6\nDATAPACKING=POINT, ZONETYPE=FEQUADRILATERAL\n" + BODY,
        HEAD + "ZONE\n N = 8\n E = 6\n ZONETYPE = FEQuadrilateral\n DATAPACKING = BLOCK\n DT=(SINGLE DOUBLE)\n" + BLOCK,
        HEAD + "ZONE N=8, E=6, F=FEBLOCK, ET=QUADRILATERAL\n" + BLOCK,
        PLAIN.replace(BODY, BODY.replace("\n", " ")),
        "# a comment\n" + PLAIN.replace("ZONE", '# another\nDATASETAUXDATA a = "b"\nZONE'),
        HEAD.replace('"Z"', '"Z", "p [Pa]"') + ZONE + BODY.replace("\n", " 7.5\n", 8),
        HEAD.replace('"Z"', '"Z" "p"') + "ZONE N=8, E=6, F=FEBLOCK, ET=QUADRILATERAL, VARLOCATION=([4]=CELLCENTERED)\n"
        + BLOCK.replace("\n1 4 3 2", "\n1 2 3 4 5 6\n1 4 3 2", 1),
        HEAD.replace('"X", "Y", "Z"', '"CoordinateX" "CoordinateY" "CoordinateZ"') + ZONE + BODY,
    ],
)  # fmt: skip
def test_one_cube_in_many_spellings(tmp_path, content):
    found = read(of(tmp_path, content))
    assert found.vertices.tolist() == CUBE
    assert lists(found) == QUADS


def test_coordinates_in_another_order_and_in_the_plane(tmp_path):
    swapped = HEAD.replace('"X", "Y"', '"Y", "X"') + ZONE + "\n".join(words([[b, a, c] for a, b, c in CUBE])) + "\n"
    assert read(of(tmp_path, swapped + "\n".join(words(QUADS, first=1)))).vertices.tolist() == CUBE
    plane = "VARIABLES = X Y\nZONE N=3 E=1 ET=TRIANGLE F=FEPOINT\n0 0\n1 0\n0 1\n1 2 3\n"
    assert read(of(tmp_path, plane)).vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def test_a_repeated_corner_makes_a_triangle(tmp_path):
    body = "\n".join(words(CUBE)) + "\n" + "\n".join(words([[*t, t[2]] for t in TRIANGLES], first=1))
    assert lists(read(of(tmp_path, HEAD + ZONE.replace("E=6", "E=12") + body))) == TRIANGLES


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "variables are missing"),
        (BODY, "variables are missing"),
        (PLAIN.replace('"Z"', '"W"').replace('"Y"', '"V"'), "variables are X, V, W"),
        (PLAIN.replace('"Y"', '"X"'), "variables are X, X, Z"),
        (PLAIN.replace("ET=QUADRILATERAL", "ET=BRICK"), "kind 'BRICK'"),
        (PLAIN.replace(", ET=QUADRILATERAL", ""), "kind 'ordered'"),
        (PLAIN.replace("N=8", "I=8"), "line 3.*I is not known"),
        (PLAIN.replace("N=8", "N=8, VARSHARELIST=([1-3]=1)"), "line 3.*VARSHARELIST"),
        (PLAIN.replace("N=8", "N=8, CONNECTIVITYSHAREZONE=1"), "line 3.*CONNECTIVITYSHAREZONE"),
        (PLAIN.replace("N=8", "N=8, PASSIVEVARLIST=[3]"), "line 3.*PASSIVEVARLIST"),
        (PLAIN.replace("N=8", "N=8, N=9"), "line 3.*N stands twice"),
        (PLAIN.replace("N=8", "N=8, NODES=9"), "one whole number N or NODES"),
        (PLAIN.replace("N=8", "N=eight"), "one whole number"),
        (PLAIN.replace("N=8", "N=9"), "51 numbers, but 48"),
        (PLAIN.replace("F=FEPOINT", "F=FEMIXED"), "packed as 'FEMIXED'"),
        (PLAIN + PLAIN[PLAIN.index("ZONE") :], "line 18.*'ZONE'"),
        (HEAD + ZONE + ZONE + BODY, "line 4.*second zone"),
        (PLAIN.replace("ZONE", "GEOMETRY X=1\nZONE"), "line 3.*'GEOMETRY'"),
        (PLAIN.replace("1 0 0", "1 nan 0"), "nan"),
        (PLAIN.replace("1 4 3 2", "1 4 3 9"), "vertex 8"),
        (PLAIN.replace("1 4 3 2", "1 4 3 2.5"), "1.5|whole"),
        (PLAIN.replace("1 4 3 2", "0 4 3 2"), "vertex -1"),
    ],
)
def test_what_is_not_so_is_refused_with_its_place(tmp_path, content, said):
    with pytest.raises(FormatError, match=rf"a\.dat.*{said}"):
        read(of(tmp_path, content))
