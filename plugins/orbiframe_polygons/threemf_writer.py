"""3MF writer: triangles of the 3D Manufacturing Format, XML in an archive."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path

from orbiframe import Polyhedron
from orbiframe.files import require_triangles
from orbiframe_polygons.lines import columns_of, shaped_text
from orbiframe_polygons.loss import tell_loss
from orbiframe_polygons.threemf_reader import MODEL, RELATIONS
from orbiframe_polygons.units import in_unit

OPC = "http://schemas.openxmlformats.org/package/2006"
THREEMF = "http://schemas.microsoft.com/3dmanufacturing"
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
TYPES = (
    f'{HEAD}<Types xmlns="{OPC}/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-'
    'package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-'
    '3dmodel+xml"/></Types>\n'
)
RELATION = (
    f'{HEAD}<Relationships xmlns="{OPC}/relationships"><Relationship Target="/{MODEL}" Id="rel0" '
    f'Type="{THREEMF}/2013/01/3dmodel"/></Relationships>\n'
)


def write(path: Path, polyhedron: Polyhedron) -> None:
    """Write the triangles as one object, in millimetres, each number with the digits that round-trip.

    Coordinates in metres are converted, with a notice; those of no unit are written as they are. Raises
    FormatError for faces that are no triangles. Normals and colours are left out, with a warning.
    """
    polyhedron = in_unit(path, polyhedron, "millimetre")
    require_triangles(path, polyhedron, "3MF")
    tell_loss(path, "colours", polyhedron.colors is not None or polyhedron.face_colors is not None)
    tell_loss(path, "normals of vertices", polyhedron.normals is not None)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        # A fixed date, so that the same polyhedron gives the same bytes.
        for name, parts in (("[Content_Types].xml", [TYPES.encode()]), (RELATIONS, [RELATION.encode()])):
            archive.writestr(zipfile.ZipInfo(name), b"".join(parts), zipfile.ZIP_DEFLATED)
        model = zipfile.ZipInfo(MODEL)
        model.compress_type = zipfile.ZIP_DEFLATED
        with archive.open(model, "w", force_zip64=True) as file:
            for block in _model(polyhedron):
                file.write(block)


def _model(polyhedron: Polyhedron) -> Iterator[bytes]:
    yield (
        f'{HEAD}<model unit="millimeter" xml:lang="en" xmlns="{THREEMF}/core/2015/02"><resources>'
        '<object id="1" type="model"><mesh><vertices>\n'
    ).encode()
    yield from shaped_text(columns_of(polyhedron.vertices), ['<vertex x="', '" y="', '" z="', '"/>\n'])
    yield b"</vertices><triangles>\n"
    yield from shaped_text(list(polyhedron.triangles.T), ['<triangle v1="', '" v2="', '" v3="', '"/>\n'])
    yield b'</triangles></mesh></object></resources><build><item objectid="1"/></build></model>\n'
