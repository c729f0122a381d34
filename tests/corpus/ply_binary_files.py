"""Binary PLY files that lie, in both orders of bytes."""

from __future__ import annotations

import itertools
import struct

from corpus.answers import CORNERS, GOOD, TETRAHEDRON, Faces, Mesh, Points, Rows
from corpus.ply_text_files import BODY, header


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
