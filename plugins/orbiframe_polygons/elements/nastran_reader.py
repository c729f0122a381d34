"""Nastran reader: triangles and quadrilaterals of the bulk data."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from orbiframe import Polyhedron
from orbiframe_polygons.elements.nastran_cards import Card, cards
from orbiframe_polygons.elements.numbered import Numbered, tell_passed
from orbiframe_polygons.parts import polyhedron_of
from orbiframe_polygons.text import plain

FACES = {**dict.fromkeys(("CTRIA3", "CTRIAR"), 3), **dict.fromkeys(("CQUAD4", "CQUADR", "CSHEAR"), 4)}
SOLIDS = {"CTETRA", "CHEXA", "CPENTA", "CPYRAM", "CPYRA"}
BELOW = {"CBAR", "CBEAM", "CBEAM3", "CBEND", "CROD", "CONROD", "CTUBE", "PLOTEL", "CGAP", "CVISC", "CBUSH", "CBUSH1D"}
# Cards that leave points and faces as they are: materials, properties, loads, supports, connections, output.
HARMLESS = re.compile(
    r"MAT.*|P(?:SHELL|COMP.*|SOLID|LSOLID|BAR.*|BEAM.*|BEND|ROD|TUBE|SHEAR|BUSH.*|ELAS.*|DAMP.*|GAP|MASS|VISC|FAST|WELD|"
    r"LPLANE|PLANE|AXI.*|ARAM|ANEL|ARRAY)|"
    r"PARAM|CORD[123].*|(?:SPC|MPC|SUPORT|ASET|BSET|CSET|QSET|USET|OMIT|RELEASE)\w*|"
    r"(?:FORCE|MOMENT|PLOAD|LOAD|GRAV|ACCEL|RFORCE|TEMP|DEFORM|SLOAD|LSEQ|DLOAD|RLOAD|TLOAD|DAREA|DELAY|DPHASE)\w*|"
    r"(?:EIG|FREQ|TSTEP|NL|TABLE|TABD|TABR|TF|RANDPS|DMI|DTI|DMIG|BLSEG|BC\w|BSURF\w*|CONM|CMASS|CELAS|CDAMP|CFAST|CWELD|CSEAM|"
    r"CHBDY|RBE|RBAR|RROD|RSPLINE|RSSCON|RTRPLT|RTRIA|RJOINT|SPOINT|EPOINT|SET|DESVAR|DRESP|DVPREL|DVMREL|DVCREL|"
    r"DCONSTR|DCONADD|DOPTPRM|DLINK|DEQATN|DOPTPRM|TOPVAR|TOMVAR|SWLDPRM|MDLPRM|NSM|VIEW|RAD|CONV|PCONV|PHBDY|QBDY|QHBDY|QVECT|QVOL|"
    r"AEFACT|AELIST|AERO|AESURF|AESTAT|CAERO|PAERO|SPLINE|FLFACT|FLUTTER|MKAERO|TRIM|GUST|SNORM|SEQGP|ECHO|BAROR|BEAMOR|ACMODL|CSSCHD|TIC)\w*"
)


def read(path: Path) -> Polyhedron:
    """The triangles and quadrilaterals of the bulk data of Nastran: CTRIA3, CTRIAR, CQUAD4, CQUADR and CSHEAR.

    Cards stand in fixed columns, in long fields or between commas, in letters of any size. Bars and solids are passed
    over with a warning, as long as there are faces. Raises FormatError, by name, for every card that is not known or
    would change others: INCLUDE, points in coordinate systems of their own (in GRID or by GRDSET), superelements, cards
    that repeat fields, and elements of the second order.

    Source: MSC Nastran Quick Reference Guide.
    """
    text = plain(path, path.read_bytes()).decode("utf-8", errors="replace")
    block = Numbered(path)
    numbers: list[int] = []
    points: list[tuple[float, float, float]] = []
    faces: dict[int, list[list[int]]] = {3: [], 4: []}
    for card in cards(path, text):
        if card.name == "GRID":
            _require_plain(card, 2)
            numbers.append(card.integer(1))
            points.append((card.real(3), card.real(4), card.real(5)))
        elif card.name in FACES:
            size = FACES[card.name]
            faces[size].append(
                [len(faces[3]) + len(faces[4]), card.integer(1)] + [card.integer(3 + k) for k in range(size)]
            )
        elif card.name == "GRDSET":
            for field in (1, 2):
                _require_plain(card, field)
        elif card.name in SOLIDS or card.name in BELOW:
            block.skip(card.name, 1, solid=card.name in SOLIDS)
        elif not HARMLESS.fullmatch(card.name):
            card.refuse("this card is not known, or changes what others mean; it is not read")
    block.add_nodes(np.array(numbers, dtype=np.intp), np.array(points, dtype=np.float64).reshape(-1, 3))
    for rows in _runs(faces):
        block.add_faces(rows[:, 0], rows[:, 1:])
    tell_passed(path, [block])
    return polyhedron_of([block.part()])


def _require_plain(card: Card, field: int) -> None:
    """Raise FormatError for points in another than the basic coordinate system."""
    if card.integer(field, 0):
        card.refuse(f"points in the coordinate system {card.integer(field)} of their own are not read")


def _runs(faces: dict[int, list[list[int]]]) -> list[np.ndarray[tuple[int, int], np.dtype[np.intp]]]:
    """Runs of faces of one size in the order of the file, each row the number of the element and its corners."""
    order = sorted((rows[0], size, k) for size, found in faces.items() for k, rows in enumerate(found))
    runs: list[list[list[int]]] = []
    last = 0
    for _, size, k in order:
        if size != last:
            runs.append([])
            last = size
        runs[-1].append(faces[size][k][1:])
    return [np.array(run, dtype=np.intp) for run in runs]
