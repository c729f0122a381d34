"""G+Smo files: a few polynomial B-spline faces as a multipatch, for isogeometric analysis."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbiframe import OrbifoldSurface
from orbiframe_exact.complete_spline import DEGREE, full_knots
from orbiframe_exact.conforming import conforming as with_equal_knots
from orbiframe_exact.faces_of_surface import Quads, described, fitted
from orbiframe_exact.quad_domain import QuadDomain

Floats = NDArray[np.float64]

_FIRST = 100
# The sides t = 0, s = 1, t = 1, s = 0 as G+Smo counts them: west, east, south, north are 1 to 4.
_SIDES = (3, 2, 4, 1)


def write_gismo(
    path: Path,
    surface: OrbifoldSurface,
    *,
    faces: int = 0,
    tolerance: float = 1e-4,
    conforming: bool = False,
    quads: Quads = (),
) -> dict[str, Any]:
    """The surface as a MultiPatch of TensorBSpline2 in an XML file of G+Smo, with all interfaces.

    faces: about so many patches, 0 for as many as its topology suggests; tolerance: their largest distance from the
    surface as a share of the diagonal of its box; conforming: equal knots along strips, so that neighbours have the
    same functions on their common edge; quads: the faces of the input, as for STEP. Returns what they are in numbers.
    """
    found = fitted(surface, faces or None, tolerance, quads)
    patches = with_equal_knots(found) if conforming else found.faces
    text = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        "<xml>",
        '<MultiPatch parDim="2" id="0">',
        f'<patches type="id_range">{_FIRST} {_FIRST + found.domain.count - 1}</patches>',
        "<interfaces>",
        *_interfaces(found.domain),
        "</interfaces>",
        "</MultiPatch>",
        *(line for quad in range(found.domain.count) for line in _patch(quad, *patches[quad], surface)),
        "</xml>",
        "",
    ]
    Path(path).write_text("\n".join(text), encoding="ascii")
    points = sum(poles.shape[0] * poles.shape[1] for _, poles in patches.values())
    return described(found, surface, tolerance) | {"control_points": points, "conforming": conforming}


def _interfaces(domain: QuadDomain) -> Iterator[str]:
    """A line for each edge: patch and side, twice; to which direction each one goes; and whether it keeps its sense.

    The direction across an edge keeps its sense if it ends in one patch where it begins in the other.
    """
    for edge, sides in enumerate(domain.sides_of_edges().tolist()):
        (q, k), (p, m) = (divmod(side, 4) for side in sides)
        along = int(domain.rising[q, k] == domain.rising[p, m])
        across = int((k in (1, 2)) != (m in (1, 2)))
        assert domain.edge[q, k] == domain.edge[p, m] == edge
        to = (m % 2, 1 - m % 2) if k % 2 == 0 else (1 - m % 2, m % 2)
        kept = (along, across) if k % 2 == 0 else (across, along)
        numbers = (_FIRST + q, _SIDES[k], _FIRST + p, _SIDES[m], *to, *kept)
        yield " ".join(map(str, numbers))


def _patch(quad: int, breaks: tuple[Floats, Floats], poles: Floats, surface: OrbifoldSurface) -> Iterator[str]:
    yield f'<Geometry type="TensorBSpline2" id="{_FIRST + quad}">'
    yield '<Basis type="TensorBSplineBasis2">'
    for axis, b in enumerate(breaks):
        knots = " ".join(map(repr, full_knots(b).tolist()))
        yield f'<Basis type="BSplineBasis" index="{axis}"><KnotVector degree="{DEGREE}">{knots}</KnotVector></Basis>'
    yield "</Basis>"
    yield '<coefs geoDim="3">'
    # The first direction runs fastest.
    for point in (surface.origin + surface.scale * np.swapaxes(poles, 0, 1)).reshape(-1, 3).tolist():
        yield " ".join(map(repr, point))
    yield "</coefs>"
    yield "</Geometry>"
