from __future__ import annotations

import numpy as np
import pytest
from orbiframe_polygons.elements.nastran_reader import read
from small_meshes import CUBE, QUADS, lists
from written import written

from orbiframe import FormatError


def fixed(*words: object) -> str:
    return "".join(f"{word!s:<8}" for word in words).rstrip() + "\n"


GRIDS = [["GRID", k + 1, "", *(f"{x}." for x in point)] for k, point in enumerate(CUBE)]
SHELLS = [["CQUAD4", k + 1, 1, *(n + 1 for n in face)] for k, face in enumerate(QUADS)]
BODY = "".join(fixed(*row) for row in GRIDS + SHELLS)
PLAIN = "SOL 101\nCEND\nTITLE = a cube\nBEGIN BULK\n" + BODY + "ENDDATA\n"
LONG = "".join(f"{'GRID*':<8}{k + 1:<16}{'':<16}{x:<16}{y:<16}\n{'*':<8}{z:<16}\n" for k, (x, y, z) in enumerate(CUBE))


def of(tmp_path, content: str):
    return written(tmp_path / "a.bdf", content)


@pytest.mark.parametrize(
    "content",
    [
        PLAIN,
        BODY + "ENDDATA",
        PLAIN.replace("\n", "\r\n"),
        PLAIN.lower(),
        PLAIN.replace("1.      ", "1.0+0   ").replace("0.      ", "0.-3    "),
        PLAIN.replace("1.", "1.D0"),
        PLAIN.replace(fixed(*GRIDS[0]), "GRID,1,,0.,0.,0.\n"),
        PLAIN.replace(fixed(*GRIDS[1]), "GRID,2,,1.\n"),
        PLAIN.replace("".join(fixed(*row) for row in GRIDS), LONG),
        PLAIN.replace("GRID    1 ", "$ a comment\nGRID    1 "),
        PLAIN.replace("ENDDATA", "MAT1    1       2.1+11          .3\nPSHELL  1       1       .1\nENDDATA\nno card"),
        PLAIN.replace("CQUAD4  1       1       ", "CQUAD4\t1\t1\t"),
        PLAIN.replace("BEGIN BULK\n", "BEGIN BULK\nGRDSET                          .       .       126\n"),
    ],
)  # fmt: skip
def test_one_cube_in_many_spellings(tmp_path, content):
    found = read(of(tmp_path, content))
    assert np.allclose(found.vertices, CUBE)
    assert lists(found) == QUADS


def test_triangles_and_quads_keep_their_order(tmp_path):
    two = fixed("CTRIA3", 7, 1, 1, 4, 3) + fixed("CTRIA3", 8, 1, 1, 3, 2)
    content = PLAIN.replace(fixed(*SHELLS[3]), fixed(*SHELLS[3]) + two)
    assert [len(face) for face in lists(read(of(tmp_path, content)))] == [4, 4, 4, 4, 3, 3, 4, 4]


def test_bars_and_solids_are_left_out_and_said(tmp_path):
    more = fixed("CBAR", 20, 1, 1, 2) + fixed("CTETRA", 21, 1, 1, 2, 3, 4)
    with pytest.warns(UserWarning, match="1 CBAR, 1 CTETRA; left out"):
        assert lists(read(of(tmp_path, PLAIN.replace("ENDDATA", more + "ENDDATA")))) == QUADS


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (PLAIN.replace("ENDDATA\n", ""), "line 1[89].*without 'ENDDATA'"),
        (PLAIN.replace("BEGIN", "INCLUDE 'other.bdf'\nBEGIN"), "line 4.*includes another"),
        (PLAIN.replace("BEGIN", "   include 'other.bdf'\nBEGIN"), "line 4.*includes another"),
        (PLAIN.replace("ENDDATA", "include 'other.bdf'\nENDDATA"), "line 19.*includes another"),
        (PLAIN.replace("GRID    1       ", "GRID    1       7"), "line 5: GRID.*coordinate system 7"),
        (PLAIN.replace(fixed(*GRIDS[0]), "GRID,1,7,0.,0.,0.\n"), "line 5: GRID.*coordinate system 7"),
        (PLAIN.replace("BEGIN BULK\n", "BEGIN BULK\n" + fixed("GRDSET", "", 3)), "line 5: GRDSET.*coordinate system 3"),
        (PLAIN.replace("BEGIN BULK\n", "BEGIN BULK\n" + fixed("GRDSET", 3)), "line 5: GRDSET.*coordinate system 3"),
        (PLAIN.replace("BEGIN BULK\n", "BEGIN BULK\nGRDSET,,3\n"), "line 5: GRDSET.*coordinate system 3"),
        (PLAIN.replace("BEGIN BULK\n", "BEGIN BULK SUPER=1\n"), "line 4.*not read"),
        (PLAIN.replace("ENDDATA", "BEGIN BULK\nENDDATA"), "second BEGIN BULK"),
        (PLAIN.replace("CQUAD4  1", "CQUAD8  1"), "CQUAD8.*not read"),
        (PLAIN.replace("CQUAD4  1", "=       =1"), "=.*not read"),
        (PLAIN.replace("CQUAD4  1", "CQUAD4X 1"), "CQUAD4X.*not read"),
        (PLAIN.replace("ENDDATA", "SEBULK  1\nENDDATA"), "SEBULK.*not read"),
        (PLAIN.replace("CQUAD4  1       1       1 ", "CQUAD4  1       1       9 "), "node 9"),
        (PLAIN.replace("CQUAD4  1       1       1 ", "CQUAD4  1       1       x "), "line 13: CQUAD4.*'x' in field 4"),
        (PLAIN.replace("CQUAD4  1       1       1 ", "CQUAD4  1       1         "), "line 13: CQUAD4.*field 4"),
        (PLAIN.replace("CQUAD4  2", "CQUAD4  1"), "element 1 stands twice"),
        (PLAIN.replace("GRID    2", "GRID    1"), "node 1 stands twice"),
        (PLAIN.replace("1.", "1.e", 1), "found '1.e'"),
        (PLAIN.replace("1.", "nan", 1), "found 'nan'"),
        ("BEGIN BULK\n*       1\nENDDATA\n", "line 2.*continues no card"),
        ("BEGIN BULK\nENDDATA\n", "no triangles"),
        ("", "without 'ENDDATA'"),
    ],
)
def test_what_is_not_so_is_refused_with_its_place(tmp_path, content, said):
    with pytest.raises(FormatError, match=rf"a\.bdf.*{said}"):
        read(of(tmp_path, content))
