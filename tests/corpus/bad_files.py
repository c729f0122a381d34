"""Files that lie, made here, each with the answer that it must get: its mesh, or an error with the place.

`python tests/corpus/bad_files.py FOLDER` writes them all.
"""

from __future__ import annotations

import itertools
import struct
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

Faces = list[list[int]]
Points = list[list[float]]

CORNERS: Points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
TETRAHEDRON: Faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


@dataclass(frozen=True)
class Mesh:
    """The file is readable: these points and faces. warned: a warning goes with it."""

    points: Points
    faces: Faces
    warned: bool = False


@dataclass(frozen=True)
class Refused:
    """The file is damaged: an error with the file and these words, a regular expression."""

    words: str


@dataclass(frozen=True)
class Case:
    """A file with its answer."""

    name: str
    content: bytes
    answer: Mesh | Refused


GOOD = Mesh(CORNERS, TETRAHEDRON)


def cases() -> Iterator[Case]:
    """All files, each name once."""
    for maker in (off, obj, ply_text, ply_binary, stl_text, stl_binary, other):
        for name, content, answer in maker():
            data = content.encode() if isinstance(content, str) else content
            stem, _, suffix = name.rpartition(".")
            reason = Refused(answer) if isinstance(answer, str) else answer
            yield Case(f"{stem}.{suffix}", data, reason)


Rows = Iterator[tuple[str, str | bytes, Mesh | str]]


def named(suffix: str, rows: list[tuple[str, str | bytes, Mesh | str]]) -> Rows:
    for name, content, answer in rows:
        yield f"{name}.{suffix}", content, answer


# ---- OFF ----------------------------------------------------------------------------------------------------------

POINT_LINES = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
FACE_LINES = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"
OFF = "OFF\n4 4 6\n" + POINT_LINES + FACE_LINES
WORDS = OFF.split()

# A word that is no finite decimal number, and may stand in any text format.
NO_NUMBERS = {
    "nan": "nan",
    "minus nan": "-nan(ind)",
    "inf": "inf",
    "infinity": "-Infinity",
    "too large": "1e400",
    "hexadecimal": "0x1p3",
    "hexadecimal integer": "0x10",
    "fortran": "1d3",
    "fortran without letter": "1.5-3",
    "comma": "1,5",
    "underscore": "1_000",
    "two signs": "+-1",
    "two points": "1.2.3",
    "only a sign": "-",
    "only a point": ".",
    "no exponent": "1e",
    "letters": "one",
    "full-width digit": "１",
    "unit": "1mm",
    "imaginary": "1j",
    "c suffix": "1.0f",
    "microsoft": "1.#INF",
    "very long": "9" * 5000 + "x",
}
# Spellings of the number one.
ONES = [
    "+1",
    "1.",
    "1.0e0",
    "1E+00",
    "10e-1",
    "0.1e1",
    "01",
    "1." + "0" * 400,
    "0." + "0" * 300 + "1e301",
    "1" + "0" * 30 + "e-30",
]


def off() -> Rows:
    yield from named("off", OFF_READABLE + OFF_DAMAGED)
    for k, (name, word) in enumerate(NO_NUMBERS.items()):
        yield f"number {name}.off", OFF.replace("1 0 0", f"1 {word} 0"), "line 4: found"
        if k % 3 == 0:
            yield f"index {name}.off", OFF.replace("3 1 2 3", f"3 1 {word} 3"), "line 9: found"
    for k, word in enumerate(ONES):
        yield f"one as spelling {k}.off", OFF.replace("1 0 0", f"{word} 0 -0"), GOOD
    for size in range(len(OFF) - 2):
        if size % 9 == 0:
            yield f"cut at {size}.off", OFF[:size], "line|empty|no words"


OFF_READABLE: list[tuple[str, str | bytes, Mesh | str]] = [
    ("plain", OFF, GOOD),
    ("counts on the first line", OFF.replace("OFF\n", "OFF "), GOOD),
    ("no header", OFF.replace("OFF\n", ""), GOOD),
    ("no edge count", OFF.replace("4 4 6", "4 4"), GOOD),
    ("wrong edge count", OFF.replace("4 4 6", "4 4 999999999999"), GOOD),
    ("crlf", OFF.replace("\n", "\r\n"), GOOD),
    ("cr", OFF.replace("\n", "\r"), GOOD),
    ("mixed line ends", "OFF\r4 4 6\n" + POINT_LINES.replace("\n", "\r\n") + FACE_LINES, GOOD),
    ("byte order mark", "\ufeff" + OFF, GOOD),
    ("no last line end", OFF.rstrip("\n"), GOOD),
    ("blank lines and tabs", OFF.replace("\n", " \t\n\n").replace(" ", "\t "), GOOD),
    ("comments", "# one\n" + OFF.replace("\n", " # more\n#\n"), GOOD),
    ("comments in latin-1", OFF.encode().replace(b"OFF\n", b"OFF # gr\xfc\xdfe\n# \xe9\n"), GOOD),
    ("comments in chinese", OFF.replace("OFF\n", "OFF # 网格\n"), GOOD),
    ("a comment of five million bytes", OFF.replace("OFF\n", "OFF #" + "x" * 5_000_000 + "\n"), GOOD),
    ("all on one line", " ".join(WORDS), GOOD),
    ("a word to a line", "\n".join(WORDS), GOOD),
    ("seven words to a line", "\n".join(" ".join(WORDS[k : k + 7]) for k in range(0, len(WORDS), 7)), GOOD),
    ("two vertices to a line", "OFF\n4 4 6\n0 0 0 1 0 0\n0 1 0 0 0 1\n" + FACE_LINES, GOOD),
    ("a vertex over two lines", OFF.replace("1 0 0", "1\n0 0"), GOOD),
    (
        "two vertices to a line and coloured faces",
        "OFF\n4 4 6\n0 0 0 1 0 0\n0 1 0 0 0 1\n" + FACE_LINES.replace("\n", " 1 0 0\n"),
        GOOD,
    ),
    ("vertex colours", "COFF\n4 4 6\n" + POINT_LINES.replace("\n", " 255 0 0 255\n") + FACE_LINES, GOOD),
    ("vertex colours of three", "COFF\n4 4 6\n" + POINT_LINES.replace("\n", " 0.5 0 1\n") + FACE_LINES, GOOD),
    ("vertex normals", "NOFF\n4 4 6\n" + POINT_LINES.replace("\n", " 0 0 1\n") + FACE_LINES, GOOD),
    ("texture", "STOFF\n4 4 6\n" + POINT_LINES.replace("\n", " 0 0.5\n") + FACE_LINES, GOOD),
    (
        "face colours",
        OFF.replace("3 0 2 1", "3 0 2 1 255 0 0")
        .replace("1 3\n", "1 3 0 0 9\n")
        .replace("2 3\n", "2 3 1 1 1\n")
        .replace("0 3\n", "0 3 0 0 0\n"),
        GOOD,
    ),
    ("colour indices", OFF.replace("1 3\n", "1 3 7\n"), GOOD),
    ("some face colours", OFF.replace("3 0 2 1", "3 0 2 1 255 0 0"), Mesh(CORNERS, TETRAHEDRON, warned=True)),
    (
        "an unused vertex",
        OFF.replace("4 4 6", "5 4 6").replace("0 0 1\n", "0 0 1\n9 9 9\n"),
        Mesh([*CORNERS, [9, 9, 9]], TETRAHEDRON),
    ),
    (
        "quads and pentagons",
        "OFF\n5 2 0\n" + POINT_LINES + "1 1 1\n4 0 1 2 3\n5 4 3 2 1 0\n",
        Mesh([*CORNERS, [1, 1, 1]], [[0, 1, 2, 3], [4, 3, 2, 1, 0]]),
    ),
    (
        "a vertex twice in a quad",
        OFF.replace("3 1 2 3", "4 1 2 1 3"),
        Mesh(CORNERS, [*TETRAHEDRON[:2], [1, 2, 1, 3], TETRAHEDRON[3]]),
    ),
    (
        "a subnormal number",
        OFF.replace("1 0 0", "5e-324 0 1e-400"),
        Mesh([CORNERS[0], [5e-324, 0, 0], *CORNERS[2:]], TETRAHEDRON),
    ),
    (
        "the largest number",
        OFF.replace("1 0 0", "1.7976931348623157e308 0 0"),
        Mesh([CORNERS[0], [1.7976931348623157e308, 0, 0], *CORNERS[2:]], TETRAHEDRON),
    ),
    ("indices as decimals", OFF.replace("3 1 2 3", "3 1.0 2e0 3"), GOOD),
    ("a face line too many", OFF.replace("4 4 6", "4 3 6"), Mesh(CORNERS, TETRAHEDRON[:3], warned=True)),
    (
        "a thousand corners",
        "OFF\n1000 1 0\n"
        + "".join(f"{k} {k * k} 0\n" for k in range(1000))
        + "1000 "
        + " ".join(map(str, range(1000))),
        Mesh([[k, k * k, 0] for k in range(1000)], [list(range(1000))]),
    ),
]

OFF_DAMAGED: list[tuple[str, str | bytes, Mesh | str]] = [
    ("empty", "", "empty"),
    ("only blanks", " \n\t\r\n", "no words"),
    ("only comments", "# a\n# b\n", "no words"),
    ("only a header", "OFF\n", "line 1"),
    ("no counts", "OFF\n" + POINT_LINES, "line 3"),
    ("other words", "hello world\n", "line 1"),
    ("lower case", OFF.replace("OFF", "off"), "line 1"),
    ("html", "<html><body>404 not found</body></html>", "line 1"),
    ("four dimensions", OFF.replace("OFF", "4OFF"), "line 1.*another dimension"),
    ("n dimensions", OFF.replace("OFF\n", "nOFF\n5\n"), "line 1.*another dimension"),
    ("binary", "OFF BINARY\n" + "x" * 90, "line 1.*binary"),
    ("negative count", OFF.replace("4 4 6", "-4 4 6"), "line 2"),
    ("count with a point", OFF.replace("4 4 6", "4.5 4 6"), "line 2"),
    ("four counts", OFF.replace("4 4 6", "4 4 6 8"), "line 2"),
    ("one count", OFF.replace("4 4 6", "4"), "line 2"),
    ("zero counts", "OFF\n0 0 0\n", "no face"),
    ("no faces", "OFF\n4 0 0\n" + POINT_LINES, "no face"),
    ("a million million vertices", OFF.replace("4 4 6", "1000000000000 4 6"), "line 2.*cut short"),
    ("a million million faces", OFF.replace("4 4 6", "4 1000000000000 6"), "line 2.*cut short"),
    ("a count of thirty digits", OFF.replace("4 4 6", "9" * 30 + " 4 6"), "line 2"),
    ("a million million corners", OFF.replace("3 1 2 3", "1000000000000 1 2 3"), "line 9"),
    ("too few vertices declared", OFF.replace("4 4 6", "3 4 6"), "line 6"),
    ("too many vertices declared", OFF.replace("4 4 6", "5 4 6"), "line 2.*cut short"),
    ("too many faces declared", OFF.replace("4 4 6", "4 5 6"), "line 2.*cut short"),
    ("a coordinate too few", OFF.replace("1 0 0", "1 0"), "line 4.*2 numbers"),
    ("a coordinate too many", OFF.replace("1 0 0", "1 0 0 0"), "line 4.*4 numbers"),
    ("colours in some vertices", OFF.replace("OFF", "COFF").replace("1 0 0", "1 0 0 1 0 0"), "line 3"),
    (
        "colours without the header",
        "OFF\n4 4 6\n" + POINT_LINES.replace("\n", " 1 0 0\n") + FACE_LINES,
        "line 3.*6 numbers",
    ),
    ("normals not there", OFF.replace("OFF", "NOFF"), "line 3.*3 numbers"),
    ("a colour below zero", "COFF\n4 4 6\n" + POINT_LINES.replace("\n", " -1 0 0\n") + FACE_LINES, "colour"),
    ("a colour of a thousand", "COFF\n4 4 6\n" + POINT_LINES.replace("\n", " 1000 0 0\n") + FACE_LINES, "colour"),
    ("index too large", OFF.replace("3 1 2 3", "3 1 2 4"), "line 9.*face 2 names vertex 4"),
    ("index below zero", OFF.replace("3 1 2 3", "3 1 -2 3"), "line 9.*face 2 names vertex -2"),
    ("index of a million million", OFF.replace("3 1 2 3", "3 1 1000000000000 3"), "line 9.*1000000000000"),
    ("index of twenty digits", OFF.replace("3 1 2 3", "3 1 18446744073709551617 3"), "line 9"),
    ("index with a fraction", OFF.replace("3 1 2 3", "3 1 2.5 3"), "line 9.*2.5"),
    ("counted from one", OFF.replace("3 0 2 1\n", "3 1 3 2\n").replace("3 2 0 3", "3 3 1 4"), "line 10.*vertex 4"),
    ("face of two", OFF.replace("3 1 2 3", "2 1 2"), "line 9.*2 corners"),
    ("face of one", OFF.replace("3 1 2 3", "1 1"), "line 9.*1 corner"),
    ("face of none", OFF.replace("3 1 2 3", "0"), "line 9.*0 corner"),
    ("face of minus three", OFF.replace("3 1 2 3", "-3 1 2 3"), "line 9.*-3 corners"),
    ("face with a corner too few", OFF.replace("3 1 2 3", "3 1 2"), "line 9"),
    ("face of one vertex", OFF.replace("3 1 2 3", "3 1 1 1"), "face 2 has the vertices 1 1 1"),
    ("face of two vertices", OFF.replace("3 1 2 3", "4 1 2 1 2"), "face 2 has the vertices 1 2 1 2"),
    ("words at the end", OFF + "the end\n", "line 11.*goes on"),
    ("two numbers at the end", OFF + "0 0\n", "line 11.*goes on"),
    ("a vertex at the end", OFF + "0 0 0\n", "line 11.*goes on"),
    ("two meshes", OFF + OFF, "line 11.*goes on"),
    ("zero bytes at the end", OFF.encode() + b"\0" * 99, "line 11.*zero byte"),
    ("zero byte in a number", OFF.encode().replace(b"1 0 0", b"1 \0 0"), "line 4.*zero byte"),
    ("bell in a number", OFF.encode().replace(b"1 0 0", b"1 0\a 0"), "line 4.*byte 7"),
    ("dos end of file", OFF.encode() + b"\x1a", "line 11.*byte 26"),
    ("utf-16", OFF.encode("utf-16"), "UTF-16"),
    ("utf-16 without mark", OFF.encode("utf-16-le"), "line 1.*zero byte"),
    ("no-break blank", OFF.replace("1 0 0", "1\u00a00 0"), "line 4"),
    ("latin-1 in a number", OFF.encode().replace(b"1 0 0", b"1 \xb9 0"), "line 4"),
    ("one point", "OFF\n3 1 0\n0 0 0\n0 0 0\n0 0 0\n3 0 0 0\n", "three different"),
]


# ---- OBJ ----------------------------------------------------------------------------------------------------------

V = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
F = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
OBJ = V + F


def obj() -> Rows:
    yield from named("obj", OBJ_READABLE + OBJ_DAMAGED)
    for k, (name, word) in enumerate(NO_NUMBERS.items()):
        yield f"number {name}.obj", OBJ.replace("v 1 0 0", f"v 1 {word} 0"), "line 2: found"
        if k % 3 == 0:
            yield f"index {name}.obj", OBJ.replace("f 2 3 4", f"f 2 {word} 4"), "line 7: (found|face 2)"
    for k, word in enumerate(ONES):
        yield f"one as spelling {k}.obj", OBJ.replace("v 1 0 0", f"v {word} 0 -0"), GOOD


OBJ_READABLE: list[tuple[str, str | bytes, Mesh | str]] = [
    ("plain", OBJ, GOOD),
    ("crlf", OBJ.replace("\n", "\r\n"), GOOD),
    ("cr", OBJ.replace("\n", "\r"), GOOD),
    ("byte order mark", "\ufeff" + OBJ, GOOD),
    ("no last line end", OBJ.rstrip("\n"), GOOD),
    ("relative indices", V + "f -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\nf -2 -4 -1\n", GOOD),
    (
        "relative indices at their place",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -1 -2\nv 0 0 1\nf 1 2 4\nf -3 -2 -1\nf -2 -4 -1\n",
        GOOD,
    ),
    ("relative and absolute indices", OBJ.replace("f 2 3 4", "f 2 -2 4"), GOOD),
    ("faces before vertices", F + V, GOOD),
    ("texture and normals", V + "vt 0 0\nvn 0 0 1\n" + F.replace("f 1 3 2", "f 1/1 3//1 2/1/1"), GOOD),
    (
        "all per corner",
        V
        + "vt 0 0\nvn 0 0 1\n"
        + "".join("f " + " ".join(f"{w}/1/1" for w in line.split()[1:]) + "\n" for line in F.splitlines()),
        GOOD,
    ),
    ("slashes with nothing", OBJ.replace("f 2 3 4", "f 2/ 3// 4"), GOOD),
    ("colours", V.replace("\n", " 1 0.5 0\n") + F, GOOD),
    ("weights", V.replace("\n", " 1.0\n") + F, GOOD),
    ("colours in some vertices", OBJ.replace("v 1 0 0", "v 1 0 0 1 0 0"), Mesh(CORNERS, TETRAHEDRON, warned=True)),
    ("continuation lines", OBJ.replace("f 1 3 2", "f 1 \\\n 3 \\\n2").replace("v 1 0 0", "v 1 \\\r\n0 0"), GOOD),
    ("groups and materials", "mtllib a.mtl\no a\ng b c\ns 1\n" + V + "usemtl x\ns off\n" + F + "l 1 2\np 1\n", GOOD),
    ("material outside the folder", "mtllib ../../../etc/passwd\nmtllib /etc/shadow\n" + OBJ, GOOD),
    ("material at a pipe", "mtllib /dev/stdin\n" + OBJ, GOOD),
    ("names in latin-1", b"o gr\xfcn\ng \xff\n" + OBJ.encode(), GOOD),
    ("comments in latin-1", b"# gr\xfcn\n" + OBJ.replace("f 2 3 4", "f 2 3 4 # \u2713").encode(), GOOD),
    ("a comment of five million bytes", "#" + "x" * 5_000_000 + "\n" + OBJ, GOOD),
    ("a name of five million bytes", "o " + "x" * 5_000_000 + "\n" + OBJ, GOOD),
    ("tabs and blanks", OBJ.replace(" ", " \t ").replace("\n", "  \n\n"), GOOD),
    ("a polygon", V + "v 1 1 1\nf 1 2 3 4 5\nf 5 4 3\n", Mesh([*CORNERS, [1, 1, 1]], [[0, 1, 2, 3, 4], [4, 3, 2]])),
    (
        "a vertex twice in a quad",
        OBJ.replace("f 2 3 4", "f 2 3 2 4"),
        Mesh(CORNERS, [*TETRAHEDRON[:2], [1, 2, 1, 3], TETRAHEDRON[3]]),
    ),
    (
        "normals that differ",
        V + "vn 0 0 1\nvn 1 0 0\n" + "f 1//1 3//1 2//1\nf 1//2 2//2 4//2\nf 2//1 3//1 4//1\nf 3//1 1//1 4//1\n",
        GOOD,
    ),
]

OBJ_DAMAGED: list[tuple[str, str | bytes, Mesh | str]] = [
    ("empty", "", "empty"),
    ("only comments", "# a\n# b\n", "no faces"),
    ("only vertices", V, "no faces"),
    ("only faces", F, "line 1.*only 0"),
    ("other words", "hello\n" + OBJ, "line 1.*'hello'"),
    ("free-form curve", OBJ + "cstype bezier\n", "line 9.*'cstype'"),
    ("index zero", OBJ.replace("f 2 3 4", "f 2 0 4"), "line 7.*index 0"),
    ("index too large", OBJ.replace("f 2 3 4", "f 2 3 5"), "line 7.*face 2 names vertex"),
    ("relative index too far", OBJ.replace("f 2 3 4", "f 2 -5 4"), "line 7.*names vertex"),
    ("relative index before its vertex", "v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n", "line 3.*names vertex"),
    ("index of a million million", OBJ.replace("f 2 3 4", "f 2 1000000000000 4"), "line 7"),
    ("index of twenty digits", OBJ.replace("f 2 3 4", "f 2 18446744073709551617 4"), "line 7"),
    ("index with a fraction", OBJ.replace("f 2 3 4", "f 2 2.5 4"), "line 7.*2.5"),
    (
        "normal index too large",
        V
        + "vn 0 0 1\n"
        + "".join("f " + " ".join(f"{w}//9" for w in line.split()[1:]) + "\n" for line in F.splitlines()),
        "line 6.*normal",
    ),
    ("three slashes", OBJ.replace("f 2 3 4", "f 2 3/1/1/1 4"), "line 7.*'3/1/1/1'"),
    ("slash first", OBJ.replace("f 2 3 4", "f 2 /3 4/1"), "line 7.*'/3'"),
    ("backslash for a slash", OBJ.replace("f 2 3 4", "f 2\\1 3\\1 4\\1"), "line 7"),
    ("face of two", OBJ.replace("f 2 3 4", "f 2 3"), "line 7.*2 corners"),
    ("face of one", OBJ.replace("f 2 3 4", "f 2"), "line 7.*1 corner"),
    ("face of none", OBJ.replace("f 2 3 4", "f"), "line 7.*0 corner"),
    ("face of one vertex", OBJ.replace("f 2 3 4", "f 2 2 2"), "face 2 has the vertices 1 1 1"),
    ("a coordinate too few", OBJ.replace("v 1 0 0", "v 1 0"), "line 2.*2 numbers"),
    ("no coordinates", OBJ.replace("v 1 0 0", "v"), "line 2.*0 numbers"),
    ("five numbers", OBJ.replace("v 1 0 0", "v 1 0 0 1 1"), "line 2.*5 numbers"),
    ("eight numbers", OBJ.replace("v 1 0 0", "v 1 0 0 1 1 1 1 1"), "line 2.*8 numbers"),
    ("normal of two", "vn 0 1\n" + OBJ, "line 1.*2 numbers"),
    ("normal of nan", "vn 0 1 nan\n" + OBJ, "line 1.*'nan'"),
    ("colour of a thousand", V.replace("\n", " 1000 0 0\n") + F, "colour"),
    ("continued past the end", OBJ + "f 1 2 \\\n", "line 9"),
    ("error after a continuation", OBJ.replace("f 1 3 2", "f 1 \\\n3 2").replace("f 2 3 4", "f 2 3 x"), "line 8.*'x'"),
    ("vertex after a continued comment", "v 1 \\\n" + OBJ, "line 1"),
    ("cut in a face", OBJ[:-4], "line 8.*1 corner"),
    ("cut in a vertex", V[:-4], "no faces|numbers"),
    ("zero byte", OBJ + "\0", "line 9.*zero byte"),
    ("control byte", OBJ.replace("v 1 0 0", "v 1 0 \x01 0"), "line 2.*byte 1"),
    ("utf-16", OBJ.encode("utf-16"), "UTF-16"),
    ("this is ply", "ply\nformat ascii 1.0\n", "line 1.*'ply'"),
]


# ---- PLY ----------------------------------------------------------------------------------------------------------

PLY_HEADER = """ply
format ascii 1.0
comment made by hand
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
"""
PLY = PLY_HEADER + POINT_LINES + FACE_LINES


def ply_text() -> Rows:
    yield from named("ply", PLY_READABLE + PLY_DAMAGED)
    for k, (name, word) in enumerate(NO_NUMBERS.items()):
        yield f"number {name}.ply", PLY.replace("1 0 0", f"1 {word} 0"), "line 12: found"
        if k % 3 == 0:
            yield f"index {name}.ply", PLY.replace("3 1 2 3", f"3 1 {word} 3"), "line 17: found"
    for k, word in enumerate(ONES):
        yield f"one as spelling {k}.ply", PLY.replace("1 0 0", f"{word} 0 -0"), GOOD


def header(**changes: str) -> str:
    """The header with lines replaced: the key is the start of the line, with _ for blanks."""
    lines = PLY_HEADER.splitlines()
    for start, line in changes.items():
        k = next(k for k, old in enumerate(lines) if old.replace(" ", "_").startswith(start))
        lines[k] = line
    return "\n".join(line for line in lines if line) + "\n"


VERTEX_ELEMENT = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
FACE_ELEMENT = "element face 4\nproperty list uchar int vertex_indices\n"
BODY = POINT_LINES + FACE_LINES
ROWS = BODY.split()

PLY_READABLE: list[tuple[str, str | bytes, Mesh | str]] = [
    ("plain", PLY, GOOD),
    ("crlf", PLY.replace("\n", "\r\n"), GOOD),
    ("cr", PLY.replace("\n", "\r"), GOOD),
    ("byte order mark", "\ufeff" + PLY, GOOD),
    ("no last line end", PLY.rstrip("\n"), GOOD),
    ("blank lines in the body", PLY_HEADER + BODY.replace("\n", "\n\n"), GOOD),
    ("all rows on one line", PLY_HEADER + " ".join(ROWS), GOOD),
    ("a word to a line", PLY_HEADER + "\n".join(ROWS), GOOD),
    ("seven words to a line", PLY_HEADER + "\n".join(" ".join(ROWS[k : k + 7]) for k in range(0, len(ROWS), 7)), GOOD),
    ("two vertices to a line", PLY_HEADER + "0 0 0 1 0 0\n0 1 0 0 0 1\n" + FACE_LINES, GOOD),
    ("a comment of five million bytes", PLY.replace("made by hand", "x" * 5_000_000), GOOD),
    ("comments in latin-1", PLY.encode().replace(b"made by hand", b"gr\xfc\xdfe"), GOOD),
    ("a comment that says end_header", PLY.replace("made by hand", "end_header"), GOOD),
    ("information", PLY.replace("comment made by hand", "obj_info a b c"), GOOD),
    ("new type names", PLY.replace("float", "float64").replace("uchar int", "uint8 int32"), GOOD),
    ("vertex_index", PLY.replace("vertex_indices", "vertex_index"), GOOD),
    ("indices as floats", PLY.replace("uchar int", "uchar float"), GOOD),
    (
        "faces before vertices",
        "ply\nformat ascii 1.0\n" + FACE_ELEMENT + VERTEX_ELEMENT + "end_header\n" + FACE_LINES + POINT_LINES,
        GOOD,
    ),
    (
        "colours of bytes",
        header(element_face="property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 4")
        + POINT_LINES.replace("\n", " 255 0 7\n")
        + FACE_LINES,
        GOOD,
    ),
    (
        "an unknown list first",
        header(property_list="property list uchar float w\nproperty list uchar int vertex_indices")
        + POINT_LINES
        + FACE_LINES.replace("3 ", "2 9 9 3 ", 1).replace("\n3 ", "\n0 3 "),
        GOOD,
    ),
    (
        "an unknown element",
        header(end_header="element edge 2\nproperty int a\nproperty int b\nend_header") + BODY + "0 1\n1 2\n",
        GOOD,
    ),
    ("an empty unknown element", header(end_header="element edge 0\nend_header") + BODY, GOOD),
]

PLY_DAMAGED: list[tuple[str, str | bytes, Mesh | str]] = [
    ("empty", "", "empty"),
    ("one word", "ply", "line 1|end_header"),
    ("other words", "plyx\n" + PLY, "line 1"),
    ("upper case", PLY.replace("ply\n", "PLY\n", 1), "line 1"),
    ("no end of header", PLY.replace("end_header", ""), "end_header"),
    ("no format", header(format=""), "no line 'format'"),
    ("two formats", header(comment="format ascii 1.0"), "line 3"),
    ("unknown format", header(format="format utf8 1.0"), "line 2"),
    ("version two", header(format="format ascii 2.0"), "line 2"),
    ("unknown type", header(property_float_y="property half y"), "line 6"),
    ("unknown statement", header(comment="note made by hand"), "line 3"),
    ("a word too many", header(property_float_y="property float y y"), "line 6"),
    ("list with float count", header(property_list="property list float int vertex_indices"), "line 9"),
    ("duplicate property", header(property_float_y="property float x"), "line 6.*'x' twice"),
    ("duplicate element", header(element_face="element vertex 4"), "line 8.*twice"),
    ("property before element", header(comment="property float w"), "line 3.*before"),
    ("element without property", header(comment="element nothing 1000000000000"), "nothing.*no property"),
    ("missing coordinate", header(property_float_z="") + BODY, "line|lacks"),
    ("no y but u", header(property_float_y="property float u") + BODY, "lacks"),
    (
        "coordinate as list",
        header(property_float_y="property list uchar float y") + "0 1 0 0\n" * 4 + FACE_LINES,
        "list",
    ),
    (
        "no face element",
        PLY_HEADER.replace("element face 4\nproperty list uchar int vertex_indices\n", "") + POINT_LINES,
        "no element 'face'",
    ),
    ("no vertex element", PLY_HEADER.replace("element vertex 4\n", "element point 4\n") + BODY, "no element 'vertex'"),
    ("no list of corners", header(property_list="property int n") + POINT_LINES + "3\n" * 4, "vertex_indices"),
    (
        "corners no list",
        header(property_list="property int vertex_indices") + POINT_LINES + "3\n" * 4,
        "vertex_indices",
    ),
    ("negative count", header(element_vertex="element vertex -4"), "line 4"),
    ("count with a point", header(element_vertex="element vertex 4.0"), "line 4"),
    (
        "a million million vertices",
        header(element_vertex="element vertex 1000000000000") + BODY,
        "1000000000000 rows.*cut short",
    ),
    (
        "a million million faces",
        header(element_face="element face 1000000000000") + BODY,
        "1000000000000 rows.*cut short",
    ),
    ("a count of thirty digits", header(element_face="element face " + "9" * 30) + BODY, "line 8"),
    ("zero faces", header(element_face="element face 0") + POINT_LINES, "no face"),
    ("too few vertices declared", header(element_vertex="element vertex 3") + BODY, "line"),
    ("too few faces declared", header(element_face="element face 3") + BODY, "line 18.*goes on"),
    ("too many faces declared", header(element_face="element face 5") + BODY, "cut short"),
    ("a coordinate too few", PLY.replace("1 0 0", "1 0"), "line 12"),
    ("a coordinate too many", PLY.replace("1 0 0", "1 0 0 0"), "line 12"),
    ("index too large", PLY.replace("3 1 2 3", "3 1 2 4"), "line 17.*face 2 names vertex 4"),
    ("index below zero", PLY.replace("3 1 2 3", "3 1 -2 3"), "line 17.*vertex -2"),
    ("index of a million million", PLY.replace("3 1 2 3", "3 1 1000000000000 3"), "line 17"),
    ("index with a fraction", PLY.replace("3 1 2 3", "3 1 2.5 3"), "line 17.*2.5"),
    ("face of two", PLY.replace("3 1 2 3", "2 1 2"), "line 17.*2 corners"),
    ("face of none", PLY.replace("3 1 2 3", "0"), "line 17.*0 corner"),
    ("list of negative length", PLY.replace("3 1 2 3", "-3 1 2 3"), "line 17"),
    ("list of a million million", PLY.replace("3 1 2 3", "1000000000000 1 2 3"), "line 17"),
    ("list of a fraction", PLY.replace("3 1 2 3", "2.5 1 2 3"), "line 17"),
    ("face of two vertices", PLY.replace("3 1 2 3", "3 1 2 1"), "face 2 has the vertices 1 2 1"),
    ("comment in the body", PLY.replace("3 1 2 3", "comment x\n3 1 2 3"), "line"),
    ("words at the end", PLY + "the end\n", "line 19"),
    ("a number at the end", PLY + "7\n", "line 19.*goes on"),
    ("zero bytes at the end", PLY.encode() + b"\0\0", "line 19.*zero byte"),
    ("cut in the header", PLY_HEADER[:80], "end_header"),
    ("cut after the header", PLY_HEADER, "cut short"),
    ("cut in the vertices", PLY_HEADER + POINT_LINES[:10], "cut short|line"),
    ("cut in the faces", PLY[:-4], "line|cut short"),
    (
        "a colour above its type",
        header(element_face="property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 4")
        + POINT_LINES.replace("\n", " 256 0 7\n")
        + FACE_LINES,
        "colour",
    ),
    ("triangle strips", header(element_face="element tristrips 1") + POINT_LINES + "4 0 1 2 3\n", "no element 'face'"),
    ("utf-16", PLY.encode("utf-16"), "line 1"),
]


def ply_binary() -> Rows:
    for order, name in (("<", "little"), (">", "big")):
        for case, content, answer in _binary_cases(order, name):
            yield f"{name} endian {case}.ply", content, answer


def packed(
    order: str, name: str, points: Points = CORNERS, faces: Faces = TETRAHEDRON, *, form: str = "f", **changes: str
) -> bytes:
    """A binary PLY file; form: how coordinates are stored, whatever the header says."""
    body = struct.pack(f"{order}{3 * len(points)}{form}", *itertools.chain(*points))
    lists = b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces)
    return header(format=f"format binary_{name}_endian 1.0", **changes).encode() + body + lists


def _binary_cases(order: str, name: str) -> list[tuple[str, bytes, Mesh | str]]:
    good = packed(order, name)
    start = len(good) - 48 - 4 * 13
    double = {
        "property_float_x": "property double x",
        "property_float_y": "property double y",
        "property_float_z": "property double z",
    }
    nan, inf = float("nan"), float("inf")
    mixed: Faces = [[0, 2, 1], [0, 1, 2, 3], [1, 2, 3], [2, 0, 3]]
    return [
        ("plain", good, GOOD),
        ("double", packed(order, name, form="d", **double), GOOD),
        ("crlf header", good[:start].replace(b"\n", b"\r\n") + good[start:], GOOD),
        ("cr header", good[:start].replace(b"\n", b"\r") + good[start:], GOOD),
        ("mixed faces", packed(order, name, faces=mixed), Mesh(CORNERS, mixed)),
        (
            "line ends in the body",
            packed(order, name, [[10, 13, 2], *CORNERS[1:]]),
            Mesh([[10, 13, 2], *CORNERS[1:]], TETRAHEDRON),
        ),
        ("double declared and float stored", packed(order, name, **double), "byte"),
        ("float declared and double stored", packed(order, name, form="d"), "byte"),
        ("one double declared", packed(order, name, property_float_y="property double y"), "byte"),
        ("cut by a byte", good[:-1], "byte.*row 3|byte"),
        ("cut in the vertices", good[: start + 30], f"byte {start}"),
        ("cut at the body", good[:start], f"byte {start}.*cut short"),
        ("a byte too many", good + b"\0", f"byte {len(good)}.*goes on for 1|byte {len(good)}.*goes on"),
        ("text after the end", good + b"# the end\n", f"byte {len(good)}.*goes on"),
        ("crlf in the body", good.replace(b"\0\0\0", b"\0\r\n\0\0"), "byte|line"),
        (
            "a million million vertices",
            packed(order, name, element_vertex="element vertex 1000000000000"),
            f"byte {start + 12}.*1000000000000 rows",
        ),
        (
            "a million million faces",
            packed(order, name, element_face="element face 1000000000000"),
            "byte.*1000000000000 rows",
        ),
        ("nan", packed(order, name, [*CORNERS[:3], [0, nan, 0]]), "byte.*nan"),
        ("inf", packed(order, name, [*CORNERS[:3], [0, inf, 0]]), "byte.*inf"),
        ("index too large", packed(order, name, faces=[*TETRAHEDRON[:3], [2, 0, 4]]), "byte.*face 3 names vertex 4"),
        ("index below zero", packed(order, name, faces=[*TETRAHEDRON[:3], [2, 0, -1]]), "byte.*face 3 names vertex -1"),
        (
            "index too large in mixed faces",
            packed(order, name, faces=[*mixed[:3], [2, 0, 4]]),
            "byte.*face 3 names vertex 4",
        ),
        ("face of two", packed(order, name, faces=[*TETRAHEDRON[:3], [2, 0]]), "byte.*2 corners"),
        ("face of none", packed(order, name, faces=[[], *TETRAHEDRON[1:]]), "byte.*0 corners"),
        ("list longer than the file", good[:-13] + b"\xff" + good[-12:], "byte"),
        (
            "list of negative length",
            packed(order, name, property_list="property list char int vertex_indices")[:-13] + b"\x80" + good[-12:],
            "byte",
        ),
        (
            "int lengths declared and bytes stored",
            packed(order, name, property_list="property list int int vertex_indices"),
            "byte",
        ),
        (
            "short indices declared and ints stored",
            packed(order, name, property_list="property list uchar short vertex_indices"),
            "byte",
        ),
        (
            "the other order declared",
            good.replace(b"little", b"?").replace(b"big", b"little").replace(b"?", b"big"),
            "byte|face",
        ),
        ("text in the body", good[:start] + BODY.encode(), "byte"),
        ("ascii declared", good.replace(f"binary_{name}_endian".encode(), b"ascii"), "line"),
        ("zero faces", packed(order, name, faces=[], element_face="element face 0"), "no face"),
        (
            "face of two vertices",
            packed(order, name, faces=[*TETRAHEDRON[:3], [2, 0, 2]]),
            "face 3 has the vertices 2 0 2",
        ),
    ]


# ---- STL ----------------------------------------------------------------------------------------------------------

STL_POINTS: Points = [CORNERS[k] for k in (0, 2, 1, 3)]
STL_FACES: Faces = [[0, 1, 2], [0, 2, 3], [2, 1, 3], [1, 0, 3]]
STL_GOOD = Mesh(STL_POINTS, STL_FACES)
FACETS = [[CORNERS[k] for k in face] for face in TETRAHEDRON]


def facet(corners: Points) -> str:
    lines = "".join(f"  vertex {x} {y} {z}\n" for x, y, z in corners)
    return f"facet normal 0 0 0\n outer loop\n{lines} endloop\nendfacet\n"


STL = "solid a b\n" + "".join(map(facet, FACETS)) + "endsolid a b\n"


def stl_text() -> Rows:
    yield from named("stl", STL_READABLE + STL_DAMAGED)
    for name, word in NO_NUMBERS.items():
        yield f"number {name}.stl", STL.replace("vertex 0 1 0", f"vertex 0 {word} 0", 1), "line 5: found"
    for k, word in enumerate(ONES):
        yield f"one as spelling {k}.stl", STL.replace("vertex 0 1 0", f"vertex 0 {word} -0"), STL_GOOD


STL_READABLE: list[tuple[str, str | bytes, Mesh | str]] = [
    ("plain", STL, STL_GOOD),
    ("upper case", STL.upper(), STL_GOOD),
    ("crlf", STL.replace("\n", "\r\n"), STL_GOOD),
    ("cr", STL.replace("\n", "\r"), STL_GOOD),
    ("byte order mark", "\ufeff" + STL, STL_GOOD),
    ("no name", STL.replace(" a b", ""), STL_GOOD),
    ("a name in latin-1", STL.encode().replace(b" a b", b" gr\xfcn"), STL_GOOD),
    ("a name of keywords", STL.replace(" a b", " facet normal vertex"), STL_GOOD),
    (
        "two solids",
        "solid a\n"
        + "".join(map(facet, FACETS[:2]))
        + "endsolid a\nsolid b\n"
        + "".join(map(facet, FACETS[2:]))
        + "endsolid\n",
        STL_GOOD,
    ),
    ("blank lines", STL.replace("\n", "\n\n"), STL_GOOD),
    ("a word to a line", "solid\n" + "\n".join("".join(map(facet, FACETS)).split()) + "\nendsolid\n", STL_GOOD),
    (
        "a facet to a line",
        "solid\n" + "".join(" ".join(facet(c).split()) + "\n" for c in FACETS) + "endsolid\n",
        STL_GOOD,
    ),
]

STL_DAMAGED: list[tuple[str, str | bytes, Mesh | str]] = [
    ("empty", "", "empty"),
    ("other words", "hello", "'solid'"),
    ("many other words", "hello world " * 99, "byte 80"),
    ("no facets", "solid a\nendsolid a\n", "no triangles"),
    ("no end", STL.replace("endsolid a b\n", ""), "endsolid"),
    ("cut in a facet", STL[: STL.index("endfacet")], "endsolid|not complete"),
    ("cut in a number", STL[: STL.index("endloop") - 3], "endsolid|line"),
    ("an end in a facet", STL[: STL.index("endfacet")] + "endsolid\n", "line 7.*not complete"),
    ("two vertices", STL.replace("  vertex 0 1 0\n", "", 1), "line 6"),
    ("four vertices", STL.replace("  vertex 0 1 0\n", "  vertex 0 1 0\n" * 2, 1), "line 7"),
    ("no outer loop", STL.replace(" outer loop\n", "", 1), "line 3"),
    ("no endloop", STL.replace(" endloop\n", "", 1), "line 7"),
    ("a coordinate too few", STL.replace("vertex 0 1 0", "vertex 0 1", 1), "line 5"),
    ("a coordinate too many", STL.replace("vertex 0 1 0", "vertex 0 1 0 0", 1), "line 5"),
    ("a keyword misspelt", STL.replace("vertex 0 1 0", "vortex 0 1 0", 1), "line 5.*vortex"),
    ("words after the end", STL + "the end\n", "outside"),
    ("a facet after the end", STL + facet(FACETS[0]), "outside"),
    ("zero byte", STL.encode().replace(b"vertex 0 1 0", b"vertex 0 1 \0"), "byte"),
    ("a facet of two points", STL.replace("vertex 0 1 0", "vertex 0 0 0", 1), "face 0 has the vertices 0 0 1"),
    (
        "a facet of one point",
        STL.replace("vertex 0 1 0", "vertex 0 0 0", 1).replace("vertex 1 0 0", "vertex 0 0 0", 1),
        "face 0 has the vertices 0 0 0",
    ),
]


def stl_binary() -> Rows:
    good = records(FACETS)
    yield from named(
        "STL",
        [
            ("plain", good, STL_GOOD),
            ("solid in the header", records(FACETS, head=b"solid of lies"), STL_GOOD),
            ("attributes", records(FACETS, attribute=65535), STL_GOOD),
            ("normals of nan", records(FACETS, normal=float("nan")), STL_GOOD),
            ("minus zero", records([[[x or -0.0 for x in p] for p in f] for f in FACETS]), STL_GOOD),
            ("zero bytes only", b"\0" * 84, "no triangles"),
            ("cut in the header", good[:50], "84 bytes"),
            ("cut at the count", good[:82], "84 bytes"),
            ("cut by a byte", good[:-1], "byte 80.*count 4"),
            ("cut by a facet", good[:-50], "byte 80.*count 4"),
            ("a byte too many", good + b"\0", "byte 80.*count 4"),
            ("a facet too many", good + good[-50:], "byte 80.*count 4"),
            ("count too small", records(FACETS, count=3), "byte 80.*count 3"),
            ("count of four thousand millions", records(FACETS, count=2**32 - 1), "byte 80.*count 4294967295"),
            ("count in the other order", records(FACETS, count=4 << 24), "byte 80.*count"),
            ("solid and a wrong count", records(FACETS, count=5, head=b"solid"), "byte 80.*count 5"),
            ("nan", records([*FACETS[:3], [[0, float("nan"), 0], *CORNERS[:2]]]), "byte 234.*nan"),
            ("inf", records([*FACETS[:3], [[0, float("-inf"), 0], *CORNERS[:2]]]), "byte 234.*inf"),
            ("a facet of two points", records([*FACETS[:3], [CORNERS[0], CORNERS[1], CORNERS[0]]]), "face 3"),
            ("crlf for lf", good.replace(b"\0\0", b"\0\r\n"), "byte 80"),
        ],
    )


def records(
    facets: list[Points],
    *,
    count: int | None = None,
    head: bytes = b"made by hand",
    normal: float = 0,
    attribute: int = 0,
) -> bytes:
    body = b"".join(struct.pack("<12fH", *[normal] * 3, *itertools.chain(*corners), attribute) for corners in facets)
    return head.ljust(80, b" ") + struct.pack("<I", len(facets) if count is None else count) + body


# ---- all others ---------------------------------------------------------------------------------------------------


def other() -> Rows:
    yield "archive.off.gz", b"\x1f\x8b\x08" + b"\0" * 99, "suffix '.gz' is not known"
    yield "archive.zip", b"PK\x03\x04" + b"\0" * 99, "suffix '.zip' is not known"
    yield "no suffix.", OFF, "no suffix|not known"


def main(folder: Path) -> None:
    """Write all files into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for case in cases():
        (folder / case.name).write_bytes(case.content)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
