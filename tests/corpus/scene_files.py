"""Files of scenes and of finite elements that lie: glTF, COLLADA, VTK, Abaqus, Nastran, Gmsh, Medit and Tecplot."""

from __future__ import annotations

import gzip
import json

from corpus.answers import CORNERS, GOOD, NO_NUMBERS, TETRAHEDRON, Rows, named

ROWS = [" ".join(map(str, point)) for point in CORNERS]
FROM_0 = [" ".join(map(str, face)) for face in TETRAHEDRON]
FROM_1 = [" ".join(str(n + 1) for n in face) for face in TETRAHEDRON]


def _lines(rows: list[str], lead: str = "", glue: str = " ") -> str:
    return "".join(f"{k + 1}{glue}{lead}{row}\n" for k, row in enumerate(rows))


INP = "*NODE\n" + _lines(ROWS, "", ", ").replace(" ", ", ").replace(",,", ",") + "*ELEMENT, TYPE=S3\n"
INP += _lines(FROM_1, "", ", ").replace(" ", ", ").replace(",,", ",")
BDF = "BEGIN BULK\n" + "".join(f"GRID,{k + 1},,{r.replace(' ', '.,')}.\n" for k, r in enumerate(ROWS))
BDF += "".join(f"CTRIA3,{k + 1},1,{r.replace(' ', ',')}\n" for k, r in enumerate(FROM_1)) + "ENDDATA\n"
MSH = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n" + _lines(ROWS) + "$EndNodes\n$Elements\n4\n"
MSH += _lines(FROM_1, "2 2 0 1 ") + "$EndElements\n"
MESH = "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n" + "".join(f"{r} 0\n" for r in ROWS)
MESH += "Triangles\n4\n" + "".join(f"{r} 0\n" for r in FROM_1) + "End\n"
DAT = 'VARIABLES = "X" "Y" "Z"\nZONE N=4, E=4, F=FEPOINT, ET=TRIANGLE\n' + "\n".join([*ROWS, *FROM_1]) + "\n"
VTK = "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n" + "\n".join(ROWS)
VTK += "\nPOLYGONS 4 16\n" + "".join(f"3 {r}\n" for r in FROM_0)
VTP = (
    '<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="4" NumberOfPolys="4"><Points><DataArray type="Float64" '
    f'NumberOfComponents="3" format="ascii">\n{" ".join(ROWS)}\n</DataArray></Points><Polys><DataArray type="Int32" '
    f'Name="connectivity" format="ascii">{" ".join(FROM_0)}</DataArray><DataArray type="Int32" Name="offsets" '
    'format="ascii">3 6 9 12</DataArray></Polys></Piece></PolyData></VTKFile>'
)
DAE = (
    '<COLLADA><library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="12">'
    f'{" ".join(ROWS)}</float_array><technique_common><accessor source="#a" count="4" stride="3"/>'
    '</technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>'
    '<triangles count="4"><input semantic="VERTEX" '
    f'source="#v" offset="0"/><p>{" ".join(FROM_0)}</p></triangles></mesh></geometry></library_geometries>'
    '<library_visual_scenes><visual_scene><node><instance_geometry url="#g"/></node></visual_scene>'
    "</library_visual_scenes></COLLADA>"
)
GLTF = {
    "asset": {"version": "2.0"},
    "buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64,"
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAIBAAEDAQIDAgAD"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
        {"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"},
    ],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "nodes": [{"mesh": 0}],
    "scenes": [{"nodes": [0]}],
}  # fmt: skip

PLAIN = {"inp": INP, "bdf": BDF, "msh": MSH, "mesh": MESH, "dat": DAT, "vtk": VTK, "vtp": VTP, "dae": DAE,
         "gltf": json.dumps(GLTF)}  # fmt: skip
# Formats that a cut at a line end leaves whole, as they say neither how much they hold nor where they end.
ENDLESS = {"inp"}
# Spellings that are numbers in a format, or separate two.
ALLOWED = {"inp": {"comma"}, "bdf": {"comma", "fortran", "fortran without letter"}}


def scenes() -> Rows:
    for suffix, content in PLAIN.items():
        yield from named(suffix, [("plain", content, GOOD), ("crlf", content.replace("\n", "\r\n"), GOOD)])
        yield f"packed.{suffix}.gz", gzip.compress(content.encode()), GOOD
        yield f"packed and cut.{suffix}.gz", gzip.compress(content.encode())[:-9], "no sound gzip|cut short"
        yield f"utf-16.{suffix}", content.encode("utf-16"), GOOD if suffix == "dae" else "."
        yield f"binary.{suffix}", bytes(range(256)) * 4, "."
        for size in range(1, len(content) - 2, max(1, len(content) // 12)):
            if suffix not in ENDLESS:
                yield f"cut at {size}.{suffix}", content[:size], "."
        for name, word in NO_NUMBERS.items():
            if suffix != "gltf" and name not in ALLOWED.get(suffix, ()):
                yield f"number {name}.{suffix}", _with_number(content, suffix, word), "found|lacks|no sound|numbers"


def _with_number(content: str, suffix: str, word: str) -> str:
    """The file with a coordinate 1 of the second vertex written otherwise."""
    old = {"inp": "2, 1, 0, 0", "bdf": "GRID,2,,1.,0.,0.", "msh": "2 1 0 0\n"}.get(suffix, "1 0 0")
    new = {"inp": f"2, {word}, 0, 0", "bdf": f"GRID,2,,{word},0.,0.", "msh": f"2 {word} 0 0\n"}.get(
        suffix, f"{word} 0 0"
    )
    assert old in content
    return content.replace(old, new, 1)
