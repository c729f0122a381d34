from __future__ import annotations

import contextlib

import meshio
import numpy as np
import pytest
from orbiframe_meshio import cells
from orbiframe_meshio.plugin import READ, SUFFIXES
from orbiframe_meshio.reader import read
from orbiframe_meshio.writer import write

from orbiframe import FormatError, Polyhedron
from orbiframe.testing import Lab, contract_tests

test_reader_laws = contract_tests("reader", read, suffix=".vol", counterpart=write)
test_writer_laws = contract_tests("writer", write, suffix=".post", counterpart=read)

POINTS = np.array([[0.1, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1 / 3]])
PYRAMID = Polyhedron.from_faces(POINTS, [[0, 1, 4], [3, 2, 1, 0], [1, 2, 4], [2, 3, 4], [3, 0, 4]])


# Where coordinates lose digits: the largest relative error.
ROUNDED = {".ugrid": 1e-7, **dict.fromkeys((".nas", ".bdf", ".fem"), 1e-11)}


@pytest.mark.parametrize("name", ["tetrahedron", "cube", "projective plane"])
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_declared_suffix_holds_triangles_and_quads(tmp_path, suffix, name):
    made = Lab(tmp_path).polyhedra[name]
    if suffix in cells.PLANE:
        made = made.with_vertices(made.vertices * [1, 1, 0])
    cells.save(tmp_path / f"a{suffix}", made)
    found = cells.polyhedron_of(tmp_path / f"a{suffix}")
    assert np.array_equal(found.offsets, made.offsets)
    assert np.array_equal(found.tail, made.tail)
    assert np.abs(found.vertices - made.vertices).max() <= ROUNDED.get(suffix, 0) * np.abs(made.vertices).max()


@pytest.mark.parametrize("suffix", [".vtk", ".vtu", ".msh", ".mesh", ".inp", ".nas", ".vol", ".post"])
def test_triangles_and_quads_side_by_side_keep_their_order(tmp_path, suffix):
    cells.save(tmp_path / f"a{suffix}", PYRAMID)
    found = cells.polyhedron_of(tmp_path / f"a{suffix}")
    assert np.array_equal(found.offsets, PYRAMID.offsets)
    assert np.array_equal(found.tail, PYRAMID.tail)


@pytest.mark.parametrize("suffix", [".vtk", ".vtu"])
def test_larger_polygons_where_the_format_holds_them(tmp_path, suffix):
    prism = Lab(tmp_path).polyhedra["prism"]
    cells.save(tmp_path / f"a{suffix}", prism)
    assert np.array_equal(cells.polyhedron_of(tmp_path / f"a{suffix}").tail, prism.tail)


@pytest.mark.parametrize("suffix", [*SUFFIXES, ".off", ".stl"])
def test_what_meshio_would_lose_is_refused(tmp_path, suffix):
    with pytest.raises(FormatError, match=rf"a\{suffix}.*(triangles and quads|without loss|plane)"):
        cells.save(tmp_path / f"a{suffix}", Lab(tmp_path).polyhedra["prism"])


def test_triangles_that_tecplot_would_turn_to_quads_are_refused(tmp_path):
    with pytest.raises(FormatError, match="without loss"):
        cells.save(tmp_path / "a.dat", PYRAMID)


def test_lines_and_points_are_left_out_and_solids_refused(tmp_path):
    path = tmp_path / "a.vtu"
    flat = [("line", [[0, 1]]), ("triangle", [[0, 1, 2]]), ("vertex", [[3]])]
    meshio.write(path, meshio.Mesh(POINTS, flat))
    assert cells.polyhedron_of(path).tail.tolist() == [0, 1, 2]
    meshio.write(path, meshio.Mesh(POINTS, [*flat, ("tetra", [[0, 1, 2, 4]])]))
    with pytest.raises(FormatError, match=r"a\.vtu.*tetra"):
        cells.polyhedron_of(path)
    meshio.write(path, meshio.Mesh(POINTS, flat[:1]))
    with pytest.raises(FormatError, match="no triangles"):
        cells.polyhedron_of(path)


def test_the_end_of_the_process_is_an_error(tmp_path):
    path = tmp_path / "a.off"
    path.write_text("COFF\n1 1 1\n")
    with pytest.raises(FormatError, match=r"a\.off.*cannot make sense"):
        read(path)


@pytest.mark.parametrize("bad", ["7", "-1"])
def test_an_index_out_of_range_is_refused(tmp_path, bad):
    path = tmp_path / "a.vtk"
    path.write_text(
        "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 double\n0 0 0\n1 0 0\n0 1 0\n"
        f"CELLS 1 4\n3 0 1 {bad}\nCELL_TYPES 1\n5\n"
    )
    with pytest.raises(FormatError, match=rf"a\.vtk.*vertex {bad}"):
        cells.polyhedron_of(path)


def test_xml_with_entities_is_not_opened(tmp_path):
    path = tmp_path / "a.vtu"
    path.write_text('<?xml version="1.0"?>\n<!DOCTYPE x [<!ENTITY a "aaaa">]>\n<VTKFile>&a;</VTKFile>\n')
    with pytest.raises(FormatError, match="entities"):
        cells.polyhedron_of(path)


def test_a_huge_count_is_refused_within_its_limits(tmp_path):
    path = tmp_path / "a.vtk"
    path.write_text(
        "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 9000000000000 double\n0 0 0\n"
    )
    with pytest.raises(FormatError, match=r"a\.vtk"):
        read(path, seconds=60)


def test_what_is_left_out_is_named(tmp_path):
    made = Polyhedron.from_corners(POINTS[:3], [0, 3], [0, 1, 2], normals=np.ones((3, 3)))
    with pytest.warns(UserWarning, match=r"a\.vtk.*normals"):
        write(tmp_path / "a.vtk", made)


def test_an_include_is_not_followed(tmp_path):
    cells.save(tmp_path / "inner.inp", PYRAMID)
    path = tmp_path / "outer.inp"
    path.write_text("*Include, input=inner.inp\n")
    with pytest.raises(FormatError, match=r"outer\.inp.*includes another"):
        cells.polyhedron_of(path)


@pytest.mark.parametrize("suffix", [".inp", ".nas", ".msh", ".meshb", ".dat"])
def test_what_has_a_reader_of_its_own_is_not_read_by_name(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    path.write_bytes(b"*NODE\n")
    with pytest.raises(FormatError, match=r"keywords that meshio passes over; leave the format away"):
        read(path)


@pytest.mark.parametrize("suffix", [".xdmf", ".med", ".cgns", ".exo", ".h5m"])
def test_formats_that_link_to_other_files_are_not_opened(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    path.write_bytes(b'<Xdmf Version="3.0"><DataItem Format="HDF">/etc/secret.h5:/points</DataItem></Xdmf>')
    with pytest.raises(FormatError, match="may name other files"):
        cells.polyhedron_of(path)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_an_entity_behind_much_text_is_seen(tmp_path, encoding):
    path = tmp_path / "a.vtu"
    comment = f"<!--{'x' * 100_000}-->"
    path.write_bytes(f'<?xml version="1.0"?>{comment}<!DOCTYPE a [<!ENTITY b SYSTEM "/etc/passwd">]>'.encode(encoding))
    with pytest.raises(FormatError, match="XML"):
        cells.polyhedron_of(path)


# ---- what is looked at beside meshio --------------------------------------------------------------------------------


def saved(path) -> Polyhedron:
    """The pyramid in the format of a suffix, or a cube, or its shadow, where that holds no more."""
    cube = Lab(path.parent).polyhedra["cube"]
    for made in (PYRAMID, cube, cube.with_vertices(cube.vertices * [1, 1, 0])):
        with contextlib.suppress(FormatError):
            cells.save(path, made)
            return made
    raise AssertionError(path)


@pytest.mark.parametrize("suffix", sorted(set(READ) - {".dato"}))
def test_a_file_cut_short_is_refused_or_whole(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    made, content = saved(path), path.read_bytes()
    for size in range(1, len(content), max(1, len(content) // 50)):
        path.write_bytes(content[:size])
        try:
            found = cells.polyhedron_of(path)
        except FormatError:
            continue
        assert np.array_equal(found.tail, made.tail)
        assert np.allclose(found.vertices, made.vertices)


@pytest.mark.parametrize("suffix", [".vol", ".avs", ".post", ".ugrid"])
def test_a_file_cut_short_is_not_read_for_ever(tmp_path, suffix):
    """Some readers of meshio ask for the next line again and again."""
    path = tmp_path / f"a{suffix}"
    saved(path)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(FormatError, match=str(path)):
        read(path, seconds=20)


@pytest.mark.parametrize(
    ("suffix", "old", "new", "said"),
    [
        (".post", b"$COOR", b"$INCLUDE other.dato\n$COOR", "includes another"),
        (".post", b"$COOR", b"$SYSTEM NAME=a\n$COOR", "SYSTEM.*changes what others mean"),
        (".post", b"$COOR", b"$COOR DISPLACED = 1", "COOR.*changes what others mean"),
        (".post", b"$STRUCTURE", b"$STRUCTURE\r$SYSTEM", "SYSTEM.*changes what others mean"),
        (".dato", b"$ELEMENT", b"ELEMENT", "ELEMENT.*changes what others mean"),
        (".dato", b"$ELEMENT", b"$COOR\n1 0 0 0\n$ELEMENT", "twice"),
        (".su2", b"NDIME= 2", b"NZONE= 2\nNDIME= 2", "NZONE.*changes what others mean"),
        (".su2", b"NDIME= 2", b"NDIME= 2\nNDIME= 2", "twice"),
        (".dato", b"$FIN", b"", r"without '\$FIN'"),
        (".vol", b"endmesh", b"", "without 'endmesh'"),
        (".su2", b"NELEM= 6", b"NELEM= 5", "could not parse"),
        (".su2", b"NDIME= 2", b"NDIME= 4", "dimension"),
        (".ugrid", b"8 0 6", b"8 0 5", "line 1.*the counts ask for 56 words"),
        (".ugrid", b"8 0 6", b"8 0 -6", "line 1.*seven counts"),
        (".mesh", b"End", b"", "without 'End'"),
        (".avs", b"\n1 0 tri", b"\n1 0 tri 1 2 5\n1 0 tri", "goes on"),
    ],
)
def test_what_meshio_would_believe_is_refused(tmp_path, suffix, old, new, said):
    path = tmp_path / f"a{suffix}"
    saved(path)
    content = path.read_bytes()
    assert old in content
    path.write_bytes(content.replace(old, new, 1))
    with pytest.raises(FormatError, match=f"(?s){path}.*{said}"):
        cells.polyhedron_of(path)


def test_names_of_boundaries_in_su2_are_no_trouble(tmp_path):
    path = tmp_path / "a.su2"
    made = saved(path)
    path.write_bytes(path.read_bytes().replace(b"NMARK= 0", b"NMARK= 1\nMARKER_TAG= wall\nMARKER_ELEMS= 1\n3 0 1"))
    assert np.array_equal(cells.polyhedron_of(path).tail, made.tail)


def test_su2_holds_surfaces_in_the_plane(tmp_path):
    with pytest.raises(FormatError, match=r"a\.su2.*plane"):
        cells.save(tmp_path / "a.su2", PYRAMID)


@pytest.mark.parametrize("suffix", [".vol", ".avs"])
def test_comments_in_latin_1_are_no_trouble(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    made = saved(path)
    path.write_bytes(b"# gr\xfc\xdfe\n" + path.read_bytes())
    assert np.array_equal(cells.polyhedron_of(path).tail, made.tail)


def test_a_line_of_a_megabyte_is_refused_at_once(tmp_path):
    path = tmp_path / "a.su2"
    path.write_bytes(b"NDIME= 2\n" + b"<a>" * 400_000)
    with pytest.raises(FormatError, match=r"a\.su2, line 2.*short"):
        cells.polyhedron_of(path)


def test_what_meshio_says_is_made_short(tmp_path):
    path = tmp_path / "a.su2"
    path.write_bytes(b"\0\x1b[31m word" * 2000)
    with pytest.raises(FormatError, match=r"a\.su2") as raised:
        cells.polyhedron_of(path)
    assert len(str(raised.value)) < 500
    assert str(raised.value).isprintable()
