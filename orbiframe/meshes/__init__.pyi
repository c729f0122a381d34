"""The public names of orbiframe.meshes, each with the module it lives in."""

from .bisection import Bisection as Bisection, bisected as bisected
from .coincident_points import clusters as clusters, first_of_each as first_of_each
from .defects import Defect as Defect, defects_of as defects_of, require_closed_surface as require_closed_surface
from .edge_paths import (
    Graph as Graph,
    Spacing as Spacing,
    covering_points as covering_points,
    curve_order as curve_order,
    dijkstra_forest as dijkstra_forest,
    edge_graph as edge_graph,
    farthest_points as farthest_points,
    first_largest as first_largest,
    joining_edges as joining_edges,
    outermost_vertex as outermost_vertex,
)
from .face_diagonals import outline as outline, triangulated as triangulated
from .fans import fan_labels as fan_labels
from .loops import Loop as Loop, boundary_loops as boundary_loops
from .marked_edges import MarkedEdges as MarkedEdges
from .orientation import oriented as oriented, reversed_faces as reversed_faces
from .polyhedron import Polyhedron as Polyhedron
from .quad_blocks import blocks_near as blocks_near
from .repair import (
    component as component,
    drop_degenerate as drop_degenerate,
    orient as orient,
    split_nonmanifold_vertices as split_nonmanifold_vertices,
    triangulate as triangulate,
    weld as weld,
)
from .subdivision import Refinement as Refinement, grid_of as grid_of, refine as refine
from .surface_type import (
    SurfaceType as SurfaceType,
    doubled_edges as doubled_edges,
    without_unused_vertices as without_unused_vertices,
)
from .unions import disjoint_union as disjoint_union
