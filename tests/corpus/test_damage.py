"""Valid files with bytes and lines changed at random: a sound polyhedron or FormatError, and nothing else."""

from __future__ import annotations

import io
import warnings
import zipfile

import numpy as np
import pytest
from corpus import answers, obj_files, off_files, ply_binary_files, ply_text_files, stl_files
from hypothesis import HealthCheck, given, settings, strategies as st
from orbiframe_polygons.threemf_reader import MODEL, RELATIONS
from orbiframe_polygons.threemf_writer import RELATION

from orbiframe import FormatError
from orbiframe.components.registry import Registry
from orbiframe.files import gate, soundness

REGISTRY = Registry.discover()
VALID = {
    "colours.off": b"COFF\n4 4 6\n"
    + off_files.POINT_LINES.replace("\n", " 1 0 0\n").encode()
    + off_files.FACE_LINES.encode(),
    "plain.off": off_files.OFF.encode(),
    "normals.obj": b"vn 0 0 1\n" + obj_files.V.encode() + b"f 1//1 3//-1 2//1\nf 1 2 4 \\\n3\nf -1 -2 -3\n",
    "plain.obj": obj_files.OBJ.encode(),
    "text.ply": ply_text_files.PLY.encode(),
    "little.ply": ply_binary_files.packed("<", "little", faces=[[0, 2, 1], [0, 1, 2, 3], [1, 2, 3], [2, 0, 3]]),
    "big.ply": ply_binary_files.packed(">", "big"),
    "text.stl": stl_files.STL.encode(),
    "binary.stl": stl_files.records(stl_files.FACETS),
}


def archive() -> bytes:
    """A 3MF file of a tetrahedron, not compressed, so that damage reaches the model."""
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in answers.CORNERS)
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in answers.TETRAHEDRON)
    mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"
    build = '<build><item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 5"/></build>'
    model = f'<model><resources><object id="1">{mesh}</object></resources>{build}</model>'
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w") as file:
        file.writestr(RELATIONS, RELATION)
        file.writestr(MODEL, model)
    return memory.getvalue()


VALID["model.3mf"] = archive()
VALID["mixed.xdmf"] = b"""<Xdmf Version="3.0"><Domain><Grid>
<Geometry GeometryType="XYZ"><DataItem Dimensions="4 3" Format="XML">
0 0 0  1 0 0  0 1 0  0 0 1 </DataItem></Geometry>
<Topology TopologyType="Mixed"><DataItem Format="XML">4 0 2 1
5 0 1 2 3  3 3 1 2 3</DataItem></Topology></Grid></Domain></Xdmf>"""
# What is worth putting in: ends of lines, signs, numbers that are none, and bytes of any kind.
PIECES = st.one_of(
    st.sampled_from(
        [
            b"\n",
            b"\r",
            b"\r\n",
            b" ",
            b"-",
            b"/",
            b"#",
            b"\\\n",
            b"nan",
            b"1e999",
            b"1000000000000",
            b"0",
            b"\0",
            b"\x80",
            b"\xff\xff\xff\xff",
        ]
    ),
    st.binary(min_size=1, max_size=4),
)


@st.composite
def damaged(draw, content):
    for _ in range(draw(st.integers(1, 4))):
        first = draw(st.integers(0, len(content)))
        last = min(len(content), first + draw(st.sampled_from([0, 1, 1, 2, 4, 13, 50])))
        what = draw(st.sampled_from(["replace", "delete", "repeat", "move a line", "drop a line"]))
        if what.endswith("line"):
            lines = content.splitlines(keepends=True)
            line = lines.pop(draw(st.integers(0, len(lines) - 1))) if lines else b""
            if what == "move a line":
                lines.insert(draw(st.integers(0, len(lines))), line)
            content = b"".join(lines)
        else:
            middle = {"replace": draw(PIECES), "delete": b"", "repeat": content[first:last] * 2}[what]
            content = content[:first] + middle + content[last:]
    return content


@pytest.mark.parametrize("name", VALID)
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_damaged_file_is_read_or_refused_and_nothing_else(tmp_path, name, data):
    path = tmp_path / name
    path.write_bytes(data.draw(damaged(VALID[name])))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        try:
            found = gate.read(path, REGISTRY)
        except FormatError as error:
            found = str(error)
    if isinstance(found, str):
        assert name in found
        assert "reading failed" not in found, "the reader itself did not see it"
        return
    soundness.require_sound(found, path)
    assert np.isfinite(found.vertices).all()
