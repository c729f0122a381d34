"""OFF files that lie."""

from __future__ import annotations

import struct

from corpus.answers import CORNERS, GOOD, NO_NUMBERS, ONES, TETRAHEDRON, Mesh, Rows, named

POINT_LINES = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
FACE_LINES = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"
OFF = "OFF\n4 4 6\n" + POINT_LINES + FACE_LINES
WORDS = OFF.split()


def binary(head: bytes, colour: list[float], face_colour: list[float]) -> bytes:
    """The tetrahedron in big-endian numbers."""
    rows = b"".join(struct.pack(f">{3 + len(colour)}f", *point, *colour) for point in CORNERS)
    count = struct.pack(">i", len(face_colour)) + struct.pack(f">{len(face_colour)}f", *face_colour)
    return head + struct.pack(">3i", 4, 4, 6) + rows + b"".join(struct.pack(">4i", 3, *f) + count for f in TETRAHEDRON)


BINARY = binary(b"OFF BINARY\n", [], [])
COLOURED_BINARY = binary(b"COFF BINARY\n", [1, 0.5, 0, 1], [0.5, 0.5, 0.25])


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
    ("header and counts in one word", OFF.replace("OFF\n", "OFF"), GOOD),
    ("binary", BINARY, GOOD),
    ("binary with colours", COLOURED_BINARY, GOOD),
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
    ("binary that is none", "OFF BINARY\n" + "x" * 90, "byte 11.*binary"),
    ("binary cut short", BINARY[:-4], "byte .*does not fit"),
    ("binary with more", BINARY + bytes(4), "byte .*cut short|declared|does not end"),
    ("binary with a huge count", BINARY.replace(b"\0\0\0\4", b"\x7f\0\0\4", 1), "byte 11.*declared"),
    (
        "binary with an index too large",
        BINARY.replace(struct.pack(">5i", 3, 2, 0, 3, 0), struct.pack(">5i", 3, 2, 0, 4, 0)),
        "byte .*vertex 4",
    ),
    ("header and counts in one word of another dimension", OFF.replace("OFF\n", "4OFF"), "line 1.*another dimension"),
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
        Mesh(CORNERS, TETRAHEDRON, warned=True),
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
