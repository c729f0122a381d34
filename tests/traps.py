"""Files of every format that name another file, the canary, in every way that a library might follow."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from collections.abc import Iterator
from pathlib import Path

from corpus.obj_files import OBJ
from corpus.off_files import OFF
from corpus.ply_text_files import PLY
from small_meshes import CUBE, QUADS, words

CANARY = "canary"


def gltf(uri: str, *, key: str = '"uri"', image: str = "") -> str:
    """A glTF whose buffer stands elsewhere; the key may be spelled anyhow."""
    images = f', "images": [{{"uri": {json.dumps(image)}}}]' if image else ""
    return (
        f'{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": 36, {key}: {json.dumps(uri)}}}], "bufferViews": '
        '[{"buffer": 0, "byteLength": 36}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": '
        '"VEC3"}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}], "scenes": '
        f'[{{"nodes": [0]}}]{images}}}'
    )


def glb(text: str) -> bytes:
    data = text.encode() + b" " * (-len(text.encode()) % 4)
    return struct.pack("<4sIIII", b"glTF", 2, 20 + len(data), len(data), 0x4E4F534A) + data


EMBEDDED = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"


def gltf_traps(canary: Path) -> Iterator[tuple[str, str]]:
    near, far = f"../{CANARY}/{canary.name}", str(canary)
    for k, uri in enumerate((near, far, f"file://{far}", near.replace("/", "\\"), near.replace("..", "%2e%2e"),
                             near.replace("/", "%2f"), f"./{near}", f"x/../{near}")):  # fmt: skip
        yield f"uri {k}", gltf(uri)
    twice = gltf(EMBEDDED).replace('"uri"', f'"uri": {json.dumps(near)}, "uri"')
    yield "key twice", twice
    yield "key twice, the other last", gltf(near).replace('"uri"', f'"uri": "{EMBEDDED}", "uri"')
    yield "key with an escape", gltf(near, key='"ur\\u0069"')
    yield "key with an escape beside a plain one", twice.replace('"uri"', '"ur\\u0069"', 1)
    yield (
        "buffers twice",
        gltf(EMBEDDED).replace(
            '"bufferViews"', f'"buffers": [{{"byteLength": 36, "uri": {json.dumps(near)}}}], "bufferViews"'
        ),
    )
    yield "picture", gltf(EMBEDDED, image=near)


def numbered(rows: list[list[int]], first: int = 0, glue: str = ", ") -> str:
    return "".join(f"{k + 1}{glue}{row}\n" for k, row in enumerate(words(rows, glue, first)))


ABAQUS = "*NODE\n" + numbered(CUBE) + "*ELEMENT, TYPE=S4\n" + numbered(QUADS, 1)
NASTRAN = (
    "BEGIN BULK\n"
    + "".join(f"GRID,{k + 1},,{x}.,{y}.,{z}.\n" for k, (x, y, z) in enumerate(CUBE))
    + "".join(f"CQUAD4,{k + 1},1,{row}\n" for k, row in enumerate(words(QUADS, ",", 1)))
    + "ENDDATA\n"
)
PERMAS = (
    "$ENTER COMPONENT NAME=a\n$STRUCTURE\n$COOR\n"
    + numbered(CUBE, 0, " ")
    + "$ELEMENT TYPE=SHELL4\n"
    + numbered(QUADS, 1, " ")
    + "$FIN\n"
)
MEDIT = (
    "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n"
    + "".join(f"{row} 0\n" for row in words(CUBE))
    + "Quadrilaterals\n6\n"
    + "".join(f"{row} 0\n" for row in words(QUADS, first=1))
)


INCLUDES = (
    "*INCLUDE", "*include", " *INCLUDE", "*IN*CLUDE", "*INC LUDE", "**\r*INCLUDE", "*INCLUDE ", "*I*N*C*L*U*D*E",
    "*\x0bINCLUDE", "*NSET\x0c\n*INCLUDE", "*Include",
)  # fmt: skip


def xdmf(item: str) -> str:
    return (
        '<Xdmf Version="3.0" xmlns:xi="http://www.w3.org/2001/XInclude"><Domain><Grid><Geometry GeometryType="XYZ">'
        f'{item}</Geometry><Topology TopologyType="Triangle"><DataItem Dimensions="1 3">0 1 2</DataItem></Topology>'
        "</Grid></Domain></Xdmf>"
    )


VTU = (
    '<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="3" NumberOfCells="1"{more}><Points>'
    '<DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0</DataArray></Points><Cells>'
    '<DataArray type="Int32" Name="connectivity" format="ascii">0 1 2{text}</DataArray>'
    '<DataArray type="Int32" Name="offsets" format="ascii">3</DataArray>'
    '<DataArray type="Int32" Name="types" format="ascii">5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>'
)
DAE = (
    '<COLLADA><library_visual_scenes><visual_scene><node><instance_geometry url="{url}#g"/></node></visual_scene>'
    "</library_visual_scenes></COLLADA>"
)


def archive(files: dict[str, str]) -> bytes:
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w") as file:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name)
            # A link, as the archives of Unix hold them.
            entry.external_attr = 0o120777 << 16
            file.writestr(entry, content)
    return memory.getvalue()


def traps(canary: Path) -> Iterator[tuple[str, bytes]]:
    """Names and contents of files that name the canary."""
    near, far = f"../{CANARY}/{canary.name}", str(canary)
    entity = f'<!DOCTYPE a [<!ENTITY b SYSTEM "file://{far}">]>'
    outside, parameter = f'<!DOCTYPE a SYSTEM "file://{far}">', f'<!DOCTYPE a [<!ENTITY % b SYSTEM "{near}"> %b;]>'
    for name, text in gltf_traps(canary):
        yield f"{name}.gltf", text.encode()
        yield f"{name}.glb", glb(text)
    for k, line in enumerate(INCLUDES):
        yield f"include {k}.inp", f"{ABAQUS}{line}, INPUT={near}\n".encode()
        yield f"include first {k}.inp", f"{line},INPUT={far}\n{ABAQUS}".encode()
    yield "nodes elsewhere.inp", ABAQUS.replace("*NODE", f"*NODE, INPUT={near}").encode()
    for k, line in enumerate(("INCLUDE", "include", "  INCLUDE", "InClUdE", "\tINCLUDE", "$\rINCLUDE")):
        for suffix in (".bdf", ".nas", ".fem"):
            yield f"include {k}{suffix}", f"{line} '{far}'\n{NASTRAN}".encode()
        yield f"include {k}.dato", PERMAS.replace("$COOR", f"${line} {near}\n$COOR").encode()
    yield "include.mesh", f'{MEDIT}IncludeFile "{far}"\nEnd\n'.encode()
    yield "geometry.mesh", f'{MEDIT}Geometry\n"{far}"\nEnd\n'.encode()
    yield "merge.msh", f"Merge '{far}';\n".encode()
    yield "material.obj", f"mtllib {near}\nmtllib {far}\nusemtl a\nmap_Kd {near}\n{OBJ}".encode()
    yield "call.obj", f"call {near}\n{OBJ}".encode()
    yield "csh.obj", f"csh cat {far}\n{OBJ}".encode()
    yield "texture.ply", PLY.replace("made by hand", f"TextureFile {near}").encode()
    yield "comment.off", f"OFF # {far}\n{OFF[4:]}".encode()
    yield "define.off", f"define a < {far}\n{OFF}".encode()
    for k, item in enumerate((f'<DataItem Format="HDF" Dimensions="3 3">{far}:/p</DataItem>',
                              f'<DataItem Format="Binary" Dimensions="3 3">{near}</DataItem>',
                              f'<DataItem Format="TIFF" Dimensions="3 3">{near}</DataItem>',
                              f'<xi:include href="{far}"/>', f'<DataItem Reference="{far}">1</DataItem>')):  # fmt: skip
        yield f"item {k}.xdmf", xdmf(item).encode()
    for k, head in enumerate((entity, outside, parameter)):
        yield f"entity {k}.xdmf", (head + xdmf('<DataItem Dimensions="3 3">0 0 0 1 0 0 0 1 0</DataItem>')).encode()
        yield f"entity {k}.vtu", (head + VTU.format(more="", text=" &b;" if k == 0 else "")).encode()
        yield f"entity {k}.dae", (head + DAE.format(url="")).encode()
    yield "piece.vtu", VTU.format(more=f' Source="{near}"', text="").encode()
    for k, url in enumerate((near, f"file://{far}", far)):
        yield f"scene {k}.dae", DAE.format(url=url).encode()
    yield "picture.fbx", b"Kaydara FBX Binary  \0\x1a\0" + f"RelativeFilename{near}FileName{far}".encode()
    yield (
        "text.fbx",
        f'; FBX 7.4.0 project file\nObjects: {{ Video: 1, "a", "Clip" {{ Filename: "{far}" }} }}\n'.encode(),
    )
    yield "link.zip", archive({"mesh.off": far})
    yield "climb.zip", archive({f"../{near}.off": OFF})
    kind = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    relation = f'<Relationships><Relationship Target="{{}}" Type="{kind}"/></Relationships>'
    yield "target.3mf", archive({"_rels/.rels": relation.format(near)})
    yield "target far.3mf", archive({"_rels/.rels": relation.format(far), far: "<model/>"})
    yield "canary.su2", f"NDIME= 3\nMESH_FILENAME= {far}\n".encode()
    yield "file.dat", f'VARIABLES = X Y Z\n$!INCLUDEMACRO "{far}"\n'.encode()
    for suffix in (".med", ".cgns", ".h5m", ".xml", ".e", ".mdpa", ".ele", ".wkt", ".svg"):
        yield f"other{suffix}", f"{far}\n{near}".encode()
