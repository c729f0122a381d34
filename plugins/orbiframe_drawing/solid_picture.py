"""Pictures of surfaces in space: a polyhedron, a polyhedron with the loops that cut it open, a smooth surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from orbiframe import Group, Marking, OrbifoldSurface, Polyhedron
from orbiframe.meshes import outline, refine
from orbiframe.triangulations import Tessellation
from orbiframe.words import text_of
from orbiframe_drawing.colours import INK, line_colour
from orbiframe_drawing.group_picture import group_picture
from orbiframe_drawing.page import MARGIN
from orbiframe_drawing.picture import Item, Label, Picture, Shape, beside
from orbiframe_drawing.solid import VIEW, Solid3D
from orbiframe_drawing.tessellation_picture import tessellation_picture

Floats = NDArray[np.float64]
View = tuple[float, float, float]

_SPACE = 440.0  # width of a surface in space, in points
_FINE = 30_000  # triangles of a smooth surface, or a few more


def surface_picture(
    surface: OrbifoldSurface, polyhedron: Polyhedron, tiling: Picture | None = None, *, view: View = VIEW
) -> Picture:
    """The smooth surface with the images of the edges of its polyhedron, beside the tessellation of X (figure 11b).

    polyhedron: whose triangles are `surface.refinement.coarse`; its own faces are shown, not the triangles; tiling: the
    picture of the tessellation, by default as `tessellation_picture` makes it; view: from the surface to the eye.
    """
    coarse = surface.refinement.coarse
    density = max(int(np.sqrt(_FINE / coarse.face_count)), 1)
    solid = Solid3D(surface.tessellate(density), _SPACE, view, smooth=True)
    lines = list(solid.polyhedron.vertices[edge_chains(polyhedron, surface, density)])
    drawn: list[Item] = [solid.image(), Shape(solid.lines(lines), stroke=line_colour(1), width=0.5)]
    if tiling is None:
        tiling = tessellation_picture(Tessellation.of_map(polyhedron, surface.refinement, surface.triangulation))
    return beside([Picture(tuple(drawn), solid.box).padded(MARGIN), tiling])


def edge_chains(polyhedron: Polyhedron, surface: OrbifoldSurface, density: int) -> NDArray[np.intp]:
    """The vertices of `surface.tessellate(density)` along every edge of the polyhedron, (E, density + 1)."""
    coarse = surface.refinement.coarse
    halfedge = outline(polyhedron)[polyhedron.representative]
    tail, head = coarse.tail[halfedge], coarse.head[halfedge]
    # Halfedge h of the coarse mesh is cut into density pieces; the vertices between them follow those of the edge.
    first = len(coarse.vertices) + coarse.edge[halfedge][:, None] * (density - 1)
    inner = first + np.arange(density - 1)
    forward = (coarse.representative[halfedge] | coarse.same[halfedge])[:, None]
    inner = np.where(forward, inner, inner[:, ::-1])
    chains = np.concatenate([tail[:, None], inner, head[:, None]], axis=1)
    if surface.own.all():
        return chains
    # A tessellation has no triangles that only close the mesh, and counts its vertices without theirs.
    refined = refine(coarse, density)
    own = surface.own[refined.origin][refined.polyhedron.face]
    return np.searchsorted(np.unique(refined.polyhedron.tail[own]), chains)


def cut_picture(marking: Marking, group: Group, *, view: View = VIEW) -> Picture:
    """The polyhedron with the loops that cut it open to a disc, beside the polygon that its boundary is (figure 11a).

    group: of a polygon with the word of the marking. Loops and sides of one letter have one colour; hidden parts of
    loops are dashed.
    """
    solid = Solid3D(marking.polyhedron, _SPACE, view)
    points = marking.polyhedron.vertices
    ends = np.stack([marking.polyhedron.tail, marking.polyhedron.head], axis=1)
    edges = points[ends[marking.polyhedron.representative]]
    items: list[Item] = [solid.image(), Shape(solid.lines(list(edges)), stroke=INK, width=0.35)]
    for letter, loop in enumerate(marking.loops, start=1):
        colour = line_colour(letter)
        items.append(Shape(solid.lines([points[loop]], hidden=True), stroke=colour, width=1.0, dash=(2.5, 3.0)))
        items.append(Shape(solid.lines([points[loop]]), stroke="#ffffff", width=4.0))
        items.append(Shape(solid.lines([points[loop]]), stroke=colour, width=2.2))
    for letter, halfedge in enumerate(marking.sides, start=1):
        middle = points[[marking.polyhedron.tail[halfedge], marking.polyhedron.head[halfedge]]].mean(axis=0)
        items.append(Label(text_of(letter), solid.place(middle[None])[0, :2], 13.0, line_colour(letter), halo=True))
    drawn = tuple(item for item in items if not isinstance(item, Shape) or len(item.paths))
    return beside([Picture(drawn, solid.box).padded(MARGIN), group_picture(group, tiles=1)])
