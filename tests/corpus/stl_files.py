"""STL files that lie, as text and binary."""

from __future__ import annotations

import itertools
import struct

from corpus.answers import CORNERS, NO_NUMBERS, ONES, TETRAHEDRON, Faces, Mesh, Points, Rows, named

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
    ("ends in two words", STL.replace("end", "end ").upper(), STL_GOOD),
    ("an end in two words", STL.replace("endsolid", "end solid"), STL_GOOD),
    ("an end with a tabulator", STL.replace("endfacet", "end\tfacet"), STL_GOOD),
    ("a name of ends", STL.replace(" a b", " end solid"), STL_GOOD),
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
