from __future__ import annotations

import itertools
import struct
import warnings
import zlib
from base64 import b64encode

import numpy as np
import pytest
from orbiframe_polygons.vtk import lz4
from orbiframe_polygons.vtk.reader import read
from orbiframe_polygons.vtk.writer import write
from small_meshes import CUBE, QUADS, lists, volume, words
from written import written

from orbiframe import FormatError, Polyhedron
from orbiframe.testing import Lab, contract_tests

test_reader_laws = contract_tests("reader", read, suffix=".vtp", counterpart=write)
test_writer_laws = contract_tests("writer", write, suffix=".vtk", counterpart=read)

POINTS = "\n".join(words(CUBE))
OLD = "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET POLYDATA\nPOINTS 8 float\n" + POINTS + "\n"
NEW = OLD.replace("3.0", "5.1")
POLYGONS = "POLYGONS 6 30\n" + "\n".join("4 " + row for row in words(QUADS)) + "\n"
LISTS = "OFFSETS vtktypeint64\n0 4 8 12 16 20 24\nCONNECTIVITY vtktypeint64\n" + " ".join(words(QUADS)) + "\n"
PLAIN = OLD + POLYGONS
GRID = (
    OLD.replace("POLYDATA", "UNSTRUCTURED_GRID") + POLYGONS.replace("POLYGONS", "CELLS") + "CELL_TYPES 6\n" + "9 " * 6
)


def of(tmp_path, content, suffix=".vtk"):
    return written(tmp_path / f"a{suffix}", content)


@pytest.mark.parametrize("suffix", [".vtk", ".vtp", ".vtu"])
@pytest.mark.parametrize("ascii", [False, True])
def test_every_polyhedron_comes_back(tmp_path, suffix, ascii):
    for made in Lab(tmp_path).polyhedra.values():
        write(tmp_path / f"a{suffix}", made, ascii=ascii)
        found = read(tmp_path / f"a{suffix}")
        assert np.array_equal(found.vertices, made.vertices)
        assert lists(found) == lists(made)


@pytest.mark.parametrize(
    "content",
    [
        PLAIN,
        GRID,
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("POLYGONS", "polygons").replace("POINTS", "Points"),
        NEW + "POLYGONS 7 24\n" + LISTS,
        NEW.replace("POLYDATA", "UNSTRUCTURED_GRID") + "CELLS 7 24\n" + LISTS + "CELL_TYPES 6\n" + "9\n" * 6,
        PLAIN.replace("POINTS", "FIELD FieldData 2\nTIME 1 1 double\n0.5\nnames 1 2 string\na%20b\nPOINTS\nPOINTS"),
        PLAIN.replace("POLYGONS", "METADATA\nINFORMATION 1\nNAME L2 LOCATION vtk\nDATA 2 0 1\n\nPOLYGONS"),
        PLAIN + "POINT_DATA 8\nNORMALS Normals float\n" + "0 0 1\n" * 8,
        PLAIN + "POINT_DATA 8\nTEXTURE_COORDINATES t 2 float\n" + "0 0\n" * 8,
        PLAIN + "CELL_DATA 6\nFIELD FieldData 1\nnames 1 6 string\na\nb\nc\nd\ne\nf\n",
        PLAIN + "POINT_DATA 8\nLOOKUP_TABLE t 2\n0 0 0 1 1 1 1 1\nVECTORS v float\n" + "0 0 1\n" * 8,
    ],
)
def test_one_cube_in_many_spellings(tmp_path, content):
    found = read(of(tmp_path, content))
    assert found.vertices.tolist() == CUBE
    assert lists(found) == QUADS


def test_lines_vertices_and_solids_are_left_out_and_said(tmp_path):
    with pytest.warns(UserWarning, match="1 lines, 2 vertices"):
        assert lists(read(of(tmp_path, OLD + "VERTICES 2 4\n1 0 1 1\nLINES 1 3\n2 0 1\n" + POLYGONS))) == QUADS
    solid = GRID.replace("CELLS 6 30", "CELLS 7 39\n8 0 1 2 3 4 5 6 7").replace("9 " * 6, "12 " + "9 " * 6)
    with pytest.warns(UserWarning, match="1 hexahedra"):
        assert lists(read(of(tmp_path, solid.replace("CELL_TYPES 6", "CELL_TYPES 7")))) == QUADS
    with pytest.raises(FormatError, match="but only lines"):
        read(of(tmp_path, OLD + "LINES 1 3\n2 0 1\n"))


def test_strips_and_pixels(tmp_path):
    strips = "TRIANGLE_STRIPS 6 30\n" + "\n".join(f"4 {a} {b} {d} {c}" for a, b, c, d in QUADS)
    assert volume(read(of(tmp_path, OLD + strips))) == pytest.approx(1)
    pixels = GRID.replace(POLYGONS[14:], "\n".join(f"4 {a} {b} {d} {c}" for a, b, c, d in QUADS) + "\n")
    assert lists(read(of(tmp_path, pixels.replace("9 " * 6, "8 " * 6)))) == QUADS


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("nothing", "line 1.*DataFile"),
        (PLAIN.replace("ASCII", "TEXT"), "line 3.*ASCII or BINARY"),
        (PLAIN.replace("POLYDATA", "STRUCTURED_GRID"), "line 4.*STRUCTURED_GRID"),
        (PLAIN.replace("POINTS 8", "POINTS 9"), "27 numbers are declared, but 24"),
        (PLAIN.replace("POINTS 8", "POINTS 7"), "21 numbers are declared, but 24"),
        (PLAIN.replace("POINTS 8", "POINTS -8"), "count"),
        (PLAIN.replace("POINTS 8 float", "POINTS 8 quaternion"), "quaternion"),
        (PLAIN.replace("1 0 0", "1 nan 0"), "NAN|nan"),
        (PLAIN.replace("4 0 3", "5 0 3"), "do not fit"),
        (PLAIN.replace("4 0 3", "4 0 8"), "names vertex 8"),
        (PLAIN.replace("4 0 3", "4 0 2.5"), "2.5"),
        (PLAIN.replace("POLYGONS 6", "POLYGONS 7"), "do not fit"),
        (PLAIN + "POLYGONS 0 0\n", "twice"),
        (
            PLAIN + "CELL_DATA 6\nSCALARS vtkGhostType unsigned_char\nLOOKUP_TABLE default\n0 0 0 0 0 1\n",
            "vtkGhostType",
        ),
        (PLAIN + "TRANSFORM 1 1\n", "TRANSFORM.*not read"),
        (PLAIN.replace("POLYGONS 6 30\n4 0 3 2 1", "POLYGONS 6 28\n2 0 3"), "2 corners"),
        (GRID.replace("9 " * 6, "9 " * 5), "6 numbers are declared"),
        (GRID.replace("9 " * 6, "9 " * 5 + "5 "), "not 3 corners"),
        (GRID.replace("9 " * 6, "9 " * 5 + "23 "), "type 23"),
        (GRID[: GRID.index("CELL_TYPES")], "no CELL_TYPES"),
        (NEW + "POLYGONS 7 24\n" + LISTS.replace("0 4 8", "1 4 8"), "offsets"),
        (NEW + "POLYGONS 7 24\n" + LISTS.replace("8 12 16", "16 12 8"), "offsets"),
        (NEW + "POLYGONS 7 24\n" + LISTS.replace("OFFSETS", "OFFSET"), "OFFSETS is required"),
        ("# vtk DataFile Version 3.0\na\nBINARY\nDATASET POLYDATA\nPOINTS 900000000000 double\n", "byte.*cut short"),
    ],
)
def test_what_is_not_so_is_refused_with_its_place(tmp_path, content, said):
    with pytest.raises(FormatError, match=rf"(?s)a\.vtk.*{said}"):
        read(of(tmp_path, content))


# ---- XML ------------------------------------------------------------------------------------------------------------


def xml(*, compressor: str = "", arrays: dict[str, str] | None = None, more: str = "", head: str = "") -> str:
    plain = {"points": " ".join(words(CUBE)), "connectivity": " ".join(words(QUADS)), "offsets": "4 8 12 16 20 24"}
    given = plain | (arrays or {})
    forms = {name: "binary" if arrays and name in arrays else "ascii" for name in plain}
    return (
        f'<?xml version="1.0"?>{head}<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" '
        f'header_type="UInt32" compressor="{compressor}"><PolyData><Piece NumberOfPoints="8" NumberOfPolys="6">'
        f'<Points><DataArray type="Float64" NumberOfComponents="3" format="{forms["points"]}">{given["points"]}'
        f'</DataArray></Points><Polys><DataArray type="Int64" Name="connectivity" format="{forms["connectivity"]}">'
        f'{given["connectivity"]}</DataArray><DataArray type="Int64" Name="offsets" format="{forms["offsets"]}">'
        f"{given['offsets']}</DataArray></Polys>"
        '<PointData><DataArray type="String" Name="names" format="ascii">ä 1 2</DataArray></PointData>'
        f"</Piece>{more}</PolyData></VTKFile>"
    )


GHOSTS = '<CellData><DataArray type="UInt8" Name="vtkGhostType" format="ascii">0 0 0 0 0 0</DataArray></CellData>'


def packed(data: bytes, blocks: list[bytes], size: int) -> str:
    """Blocks as VTK writes them: counts and sizes in base64, then the blocks in base64."""
    head = struct.pack(f"<{3 + len(blocks)}I", len(blocks), size, len(data) % size, *map(len, blocks))
    return (b64encode(head) + b64encode(b"".join(blocks))).decode()


def test_text_and_a_document_type(tmp_path):
    assert lists(read(of(tmp_path, xml(), ".vtp"))) == QUADS
    assert lists(read(of(tmp_path, xml().replace("</Piece>", GHOSTS + "</Piece>"), ".vtp"))) == QUADS
    assert lists(read(of(tmp_path, xml(head='<!DOCTYPE VTKFile SYSTEM "x.dtd">'), ".vtp"))) == QUADS


def test_compressed_blocks(tmp_path):
    data = np.array(CUBE, dtype="<f8").tobytes()
    blocks = [zlib.compress(data[k : k + 64]) for k in range(0, len(data), 64)]
    found = read(
        of(tmp_path, xml(compressor="vtkZLibDataCompressor", arrays={"points": packed(data, blocks, 64)}), ".vtp")
    )
    assert found.vertices.tolist() == CUBE


def test_a_compressed_block_that_swells_is_stopped(tmp_path):
    """A gigabyte of zeros in a megabyte of zlib."""
    size = 2**30
    packer = zlib.compressobj(9)
    block = b"".join([*(packer.compress(bytes(2**22)) for _ in range(size // 2**22)), packer.flush()])
    head = b64encode(struct.pack("<4I", 1, size, size, len(block)))
    content = xml(compressor="vtkZLibDataCompressor", arrays={"points": (head + b64encode(block)).decode()})
    with pytest.raises(FormatError, match=r"a\.vtp.*too often"):
        read(of(tmp_path, content.replace('NumberOfPoints="8"', 'NumberOfPoints="44739242"'), ".vtp"))
    small = head.replace(
        b64encode(struct.pack("<4I", 1, size, size, len(block))), b64encode(struct.pack("<4I", 1, 192, 192, len(block)))
    )
    with pytest.raises(FormatError, match=r"block 0 is damaged, or larger than it says"):
        read(
            of(
                tmp_path,
                xml(compressor="vtkZLibDataCompressor", arrays={"points": (small + b64encode(block)).decode()}),
                ".vtp",
            )
        )


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (xml().replace("PolyData", "ImageData"), "ImageData"),
        (xml().replace("VTKFile", "Other"), "Other"),
        (xml(head="<!DOCTYPE a [<!ENTITY b 'c'>]>"), "entities"),
        (xml(more='<Piece Source="other.vtp"/>'), "another file"),
        (xml(compressor="vtkOtherCompressor"), "vtkOtherCompressor"),
        (xml().replace("LittleEndian", "Middle"), "Middle"),
        (xml().replace('NumberOfPoints="8"', 'NumberOfPoints="9"'), "27 numbers are declared, but 24"),
        (xml().replace('NumberOfPolys="6"', 'NumberOfPolys="5"'), "5 numbers are declared"),
        (xml().replace("4 8 12", "4 3 12"), "offsets"),
        (xml().replace("20 24", "20 23"), "offsets"),
        (xml().replace("0 3 2 1", "0 3 2 8"), "names vertex 8"),
        (xml().replace("0 3 2 1", "0 3 2 1.5"), "1.5"),
        (xml().replace("Float64", "Float16"), "Float16"),
        (xml().replace('"connectivity"', '"other"'), "no array connectivity"),
        (xml().replace('format="ascii"', 'format="appended" offset="0"', 1), "no appended data"),
        (xml(arrays={"points": "####"}), "base64"),
        (xml(arrays={"points": "AAAA"}), "cut short"),
        (xml(arrays={"points": b64encode(struct.pack("<I", 2**31)).decode()}), "cut short"),
        (xml().replace("</Piece>", GHOSTS.replace("0 0 0", "0 0 1") + "</Piece>"), "some cells are ghosts"),
        (xml()[:-9], "no sound XML"),
    ],
)
def test_xml_that_is_not_so_is_refused(tmp_path, content, said):
    with pytest.raises(FormatError, match=rf"(?s)a\.vtp.*{said}"):
        read(of(tmp_path, content, ".vtp"))


# ---- LZ4 ------------------------------------------------------------------------------------------------------------


def test_an_lz4_block_by_hand():
    # Seven literals, a match of 9 from 3 back, then two literals.
    block = bytes([0x75]) + b"abcdefg" + bytes([3, 0, 0x20]) + b"yz"
    assert lz4.unpacked(block, 18) == b"abcdefgefgefgefgyz"
    for damaged in (
        block[:-1],
        block + b"x",
        bytes([0x75]) + b"abcdefg" + bytes([9, 0, 0x20]) + b"yz",
        b"\xff" * 9,
        b"",
    ):
        assert lz4.unpacked(damaged, 18) is None
    assert lz4.unpacked(block, 17) is None


def test_the_compiled_way_of_lz4_is_the_plain_one(monkeypatch):
    block = bytes([0xF5, 40]) + bytes(range(55)) + bytes([50, 0, 0x20]) + b"yz"
    plain = lz4.unpacked(block, 66)
    monkeypatch.setattr(lz4, "LARGE", 0)
    assert plain is not None
    assert lz4.unpacked(block, 66) == plain


# ---- files that VTK itself makes ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def sphere():
    vtk = pytest.importorskip("vtk", reason="the vtk package is not installed")
    source = vtk.vtkSphereSource()
    source.SetThetaResolution(30)
    source.SetPhiResolution(20)
    source.Update()
    made = source.GetOutput()
    names = vtk.vtkStringArray()
    names.SetName("names of points")
    for k in range(made.GetNumberOfPoints()):
        names.InsertNextValue(f"point {k}")
    made.GetPointData().AddArray(names)
    return vtk, made


def wanted(made) -> Polyhedron:
    from vtk.util.numpy_support import vtk_to_numpy

    points = vtk_to_numpy(made.GetPoints().GetData())
    return Polyhedron.from_faces(points, vtk_to_numpy(made.GetPolys().GetConnectivityArray()).reshape(-1, 3))


@pytest.mark.parametrize("kind", ["vtp", "vtu"])
def test_every_mode_of_the_xml_writers_of_vtk(tmp_path, sphere, kind):
    vtk, made = sphere
    grid = vtk.vtkAppendFilter()
    grid.AddInputData(made)
    grid.Update()
    tried = 0
    for mode, compressor, head, order, encoded in itertools.product(
        ("Ascii", "Binary", "Appended"), ("None", "ZLib", "LZ4", "LZMA"), (32, 64), ("Little", "Big"), (0, 1)
    ):
        writer = vtk.vtkXMLPolyDataWriter() if kind == "vtp" else vtk.vtkXMLUnstructuredGridWriter()
        writer.SetInputData(made if kind == "vtp" else grid.GetOutput())
        writer.SetFileName(str(tmp_path / f"a.{kind}"))
        getattr(writer, f"SetDataModeTo{mode}")()
        getattr(writer, "SetCompressorTypeToNone" if compressor == "None" else f"SetCompressorTypeTo{compressor}")()
        getattr(writer, f"SetHeaderTypeToUInt{head}")()
        getattr(writer, f"SetByteOrderTo{order}Endian")()
        writer.SetBlockSize(2048)
        writer.SetEncodeAppendedData(encoded)
        writer.Write()
        found = read(tmp_path / f"a.{kind}")
        assert np.array_equal(found.vertices.astype(np.float32), wanted(made).vertices.astype(np.float32))
        assert np.array_equal(found.tail, wanted(made).tail)
        tried += 1
    assert tried == 96


@pytest.mark.parametrize("version", [42, 51])
@pytest.mark.parametrize("binary", [1, 2])
def test_the_legacy_writers_of_vtk(tmp_path, sphere, version, binary):
    vtk, made = sphere
    stripper = vtk.vtkStripper()
    stripper.SetInputData(made)
    stripper.Update()
    for data in (made, stripper.GetOutput()):
        writer = vtk.vtkPolyDataWriter()
        writer.SetInputData(data)
        writer.SetFileVersion(version)
        writer.SetFileType(binary)
        writer.SetFileName(str(tmp_path / "a.vtk"))
        writer.Write()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found = read(tmp_path / "a.vtk")
        assert found.face_count == wanted(made).face_count
        assert volume(found) == pytest.approx(volume(wanted(made)), rel=1e-5)


def test_vtk_reads_what_is_written(tmp_path, sphere):
    vtk, made = sphere
    readers = {
        ".vtk": vtk.vtkUnstructuredGridReader,
        ".vtp": vtk.vtkXMLPolyDataReader,
        ".vtu": vtk.vtkXMLUnstructuredGridReader,
    }
    for suffix, kind in readers.items():
        write(tmp_path / f"a{suffix}", wanted(made))
        reader = kind()
        reader.SetFileName(str(tmp_path / f"a{suffix}"))
        reader.Update()
        assert reader.GetOutput().GetNumberOfCells() == wanted(made).face_count
        assert np.allclose(reader.GetOutput().GetBounds(), made.GetBounds())
