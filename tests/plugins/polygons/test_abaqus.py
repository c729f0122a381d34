from __future__ import annotations

import numpy as np
import pytest
from orbiframe_polygons.elements.abaqus_reader import read
from small_meshes import CUBE, QUADS, lists, volume
from written import written

from orbiframe import FormatError


def rows(table: list[list[int]], first: int = 0) -> str:
    return "".join(f"{k + 1}, {', '.join(str(n + first) for n in row)}\n" for k, row in enumerate(table))


NODES = "*NODE\n" + rows(CUBE)
SHELLS = "*ELEMENT, TYPE=S4R, ELSET=a\n" + rows(QUADS, 1)
FLAT = "*HEADING\na cube, and words\n** a comment\n" + NODES + SHELLS
PART = "*Part, name=p\n" + NODES + SHELLS + "*End Part\n"


def assembly(*instances: str, parts: str = PART) -> str:
    placed = "".join(f"*Instance, name=i{k}, part=p\n{place}*End Instance\n" for k, place in enumerate(instances))
    return f"*Heading\n{parts}*Assembly, name=a\n{placed}*End Assembly\n"


def of(tmp_path, content: str):
    return written(tmp_path / "a.inp", content)


@pytest.mark.parametrize(
    "content",
    [
        FLAT,
        FLAT.replace("\n", "\r\n"),
        FLAT.lower().replace("*element", "* ELEMENT"),
        FLAT.replace(", ", ","),
        FLAT.replace("1, 0, 0, 0", "1"),
        FLAT.replace("3, 2, 3, 7, 6", "3, 2,\n3, 7, 6").replace("*NODE", "*NODE,\nNSET=all"),
        FLAT.replace("6, 4, 1, 5, 8\n", "6, 4, 1, 5, 8,\n"),
        FLAT + "*NSET, NSET=a, GENERATE\n1, 8, 1\n*MATERIAL, NAME=m\n*ELASTIC\n1.,.3\n*STEP\n*STATIC\n*END STEP\n",
        FLAT.replace("*NODE\n", "*NODE, SYSTEM=R\n"),
        PART,
        assembly(""),
        "*NODE\n9, 7., 7., 7.\n" + FLAT.replace("*HEADING\na cube, and words\n", ""),
    ],
)
def test_one_cube_in_many_spellings(tmp_path, content):
    found = read(of(tmp_path, content))
    used = found.vertices[np.unique(found.tail)]
    assert used.tolist() == CUBE
    assert [len(face) for face in lists(found)] == [4] * 6
    assert volume(found) == pytest.approx(1)


def test_every_instance_is_at_its_place(tmp_path):
    found = read(of(tmp_path, assembly("", "10., 0., 0.\n", "0., 5., 0.\n0., 0., 0., 0., 0., 1., 90.\n")))
    assert len(found.vertices) == 24
    assert volume(found) == pytest.approx(3)
    boxes = [
        (found.vertices[8 * k : 8 * k + 8].min(axis=0), found.vertices[8 * k : 8 * k + 8].max(axis=0)) for k in range(3)
    ]
    assert np.allclose(boxes[1], [[10, 0, 0], [11, 1, 1]])
    # Moved by 5 along y, then a quarter about z: y goes to -x.
    assert np.allclose(boxes[2], [[-6, 0, 0], [-5, 1, 1]])


def test_an_instance_turns_about_its_axis(tmp_path):
    found = read(of(tmp_path, assembly("0., 0., 0.\n1., 0., 0., 1., 0., 5., 180.\n")))
    assert np.allclose([found.vertices.min(axis=0), found.vertices.max(axis=0)], [[1, -1, 0], [2, 0, 1]])


def test_parts_with_numbers_alike_stay_apart(tmp_path):
    other = PART.replace("name=p", "name=q").replace("8, 0, 1, 1", "8, 0, 1, 2")
    content = assembly("", parts=PART + other).replace(
        "*End Ass", "*Instance, name=j, part=q\n3,0,0\n*End Instance\n*End Ass"
    )
    found = read(of(tmp_path, content))
    assert len(found.vertices) == 16
    assert found.vertices[15].tolist() == [3, 1, 2]


def test_nodes_and_elements_of_an_instance_move_with_it(tmp_path):
    content = assembly(f"0, 0, 2\n{NODES}{SHELLS}", parts="*Part, name=p\n*End Part\n")
    assert read(of(tmp_path, content)).vertices.min(axis=0).tolist() == [0, 0, 2]


def test_lines_and_solids_are_left_out_and_said(tmp_path):
    content = FLAT + "*ELEMENT, TYPE=T3D2\n11, 1, 2\n*ELEMENT, TYPE=C3D8R\n12, 1, 2, 3, 4, 5, 6, 7, 8\n"
    with pytest.warns(UserWarning, match="1 elements C3D8R, 1 elements T3D2; left out"):
        assert len(read(of(tmp_path, content)).tail) == 24
    with pytest.raises(FormatError, match="save the surface of the solid"):
        read(of(tmp_path, NODES + "*ELEMENT, TYPE=C3D8R\n12, 1, 2, 3, 4, 5, 6, 7, 8\n"))


MAKING = ["SYSTEM", "NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "IMPERFECTION", "PARAMETER", "MODEL CHANGE",
          "INCLUDE, INPUT=other.inp", "IMPORT", "IN*CLUDE, INPUT=other.inp", "N O D E", "NODES", "USER ELEMENT",
          "MAP SOLUTION"]  # fmt: skip


@pytest.mark.parametrize("keyword", MAKING)
def test_what_makes_or_moves_a_mesh_is_refused_by_name(tmp_path, keyword):
    name = keyword.split(",")[0].replace("*", "[*]")
    for content in (FLAT + f"*{keyword}\n1, 2\n", f"*{keyword.lower()}\n" + FLAT, FLAT + f" *{keyword}"):
        with pytest.raises(FormatError, match=rf"a\.inp, line \d+: \*{name}.*not read"):
            read(of(tmp_path, content))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (FLAT.replace("*NODE", "*NODE, SYSTEM=C"), "line 4.*SYSTEM=C"),
        (FLAT.replace("*NODE", "*NODE, INPUT=a.txt"), "line 4.*INPUT"),
        (FLAT.replace("ELSET=a", "INPUT=a.txt"), "line 13.*INPUT"),
        (FLAT.replace("ELSET=a", "TYPE=S3"), "line 13.*TYPE.*twice"),
        (FLAT.replace("TYPE=S4R, ", ""), "TYPE is required"),
        (FLAT.replace("S4R", "S8R"), "S8R.*not read"),
        (FLAT.replace("S4R", "STRI65"), "STRI65"),
        (FLAT.replace("S4R", "S3"), "line 14.*5 numbers"),
        (FLAT.replace("1, 1, 4, 3, 2", "1, 1, 4, 3, 9"), "node 9"),
        (FLAT.replace("1, 1, 4, 3, 2", "1, 1, 4, 3, 2.5"), "line 14.*2.5"),
        (FLAT.replace("1, 1, 4, 3, 2", "1, 1, 4, 3"), "line 14.*4 numbers"),
        (FLAT.replace("1, 1, 4, 3, 2", "2, 1, 4, 3, 2"), "element 2 stands twice"),
        (FLAT.replace("2, 1, 0, 0", "1, 1, 0, 0"), "node 1 stands twice"),
        (FLAT.replace("2, 1, 0, 0", "2, 1, , 0"), "line 6.*between two commas"),
        (FLAT.replace("2, 1, 0, 0", "2, 1, nan, 0"), "line 6.*nan"),
        (FLAT.replace("2, 1, 0, 0", "2, 1, 1d0, 0"), "line 6.*1d0"),
        (FLAT.replace("2, 1, 0, 0", "2, 1, 0, 0, 0, 0, 0, 0"), "line 6.*8 numbers"),
        ("1, 2, 3\n" + FLAT, "line 1.*keyword"),
        (NODES, "no triangles"),
        (PART.replace("*End Part\n", ""), "ends inside [*]PART"),
        (PART + PART.replace("name=p", "name=q"), "2 parts, but no [*]INSTANCE"),
        (PART + PART, "there already"),
        (PART.replace("*NODE", "*Part, name=q\n*NODE"), "inside something else"),
        (assembly("1., 2.\n"), "line of 3 numbers"),
        (assembly("0,0,0\n1,1,1,1,1,1,90\n"), "length 0"),
        (assembly("").replace("part=p", "part=q"), "no part 'Q'"),
        (assembly("").replace("part=p", "part=p, library=x"), "LIBRARY"),
        (assembly("").replace("*End Instance\n", ""), "no [*]ASSEMBLY to end"),
        ("*Instance, part=p\n*End Instance\n" + FLAT, "inside [*]ASSEMBLY only"),
        (assembly(*[""] * 2).replace("*End Assembly", "*ELEMENT, TYPE=S3\n1, i0.1, i0.2, i0.3\n*End Assembly"), "i0.1"),
    ],
)  # fmt: skip
def test_what_is_not_so_is_refused_with_its_place(tmp_path, content, said):
    with pytest.raises(FormatError, match=rf"a\.inp.*{said}"):
        read(of(tmp_path, content))


def test_instances_that_repeat_too_often_are_refused(tmp_path):
    many = PART.replace("*NODE\n", "*NODE\n" + "".join(f"{k}\n" for k in range(10, 9000)))
    with pytest.raises(FormatError, match="too often"):
        read(of(tmp_path, assembly(*["1,1,1\n"] * 1200, parts=many)))
