"""PLY files of text that lie."""

from __future__ import annotations

from corpus.answers import CORNERS, GOOD, NO_NUMBERS, ONES, Mesh, Rows, named
from corpus.off_files import FACE_LINES, POINT_LINES

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
    (
        "ten thousand properties",
        header(property_float_z="property float z\n" + "\n".join(f"property uchar p{k}" for k in range(10_000)))
        + POINT_LINES.replace("\n", " 0" * 10_000 + "\n")
        + FACE_LINES,
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
    (
        "ten thousand elements",
        header(element_vertex="\n".join(f"element e{k} 0" for k in range(10_000)) + "\nelement vertices 4") + BODY,
        "no element 'vertex'",
    ),
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
    (
        "triangle strips",
        header(element_face="element tristrips 1") + POINT_LINES + "4 0 1 2 3\n",
        Mesh(CORNERS, [[0, 1, 2], [1, 3, 2]]),
    ),
    (
        "triangle strips with restarts",
        header(element_face="element tristrips 2") + POINT_LINES + "7 0 2 1 -1 0 1 3\n7 1 2 3 3 -1 2 0\n",
        Mesh(CORNERS, [[0, 2, 1], [0, 1, 3], [1, 2, 3]]),
    ),
    (
        "strips with an index too large",
        header(element_face="element tristrips 1") + POINT_LINES + "3 0 1 4\n",
        "vertex 4",
    ),
    ("strips with a fraction", header(element_face="element tristrips 1") + POINT_LINES + "3 0 1 1.5\n", "line 1.*1.5"),
    ("utf-16", PLY.encode("utf-16"), "line 1"),
]
