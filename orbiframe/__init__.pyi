"""The public names of orbiframe, each with the module it lives in; `__init__.py` reads this list."""

from orbiframe.orbifolds.atlas import Atlas as Atlas, Points as Points
from orbiframe.functions.basis import Basis as Basis, DifferentiableBasis as DifferentiableBasis, OrbitSumBasis as OrbitSumBasis
from orbiframe.splines.bernstein import (
    bernstein_values as bernstein_values,
    blossom as blossom,
    coefficient_count as coefficient_count,
    exponents as exponents,
    polar as polar,
    symmetric_power as symmetric_power,
)
from orbiframe.meshes.bisection import bisected as bisected
from orbiframe_invariants.named_words import (
    klein_quartic as klein_quartic,
    opposite_sides as opposite_sides,
    word_named as word_named,
)
from orbiframe_invariants.canonical_word import CanonicalWord as CanonicalWord, canonical_form as canonical_form
from orbiframe.groups.spread_points import CellSites as CellSites, sites_of_cell as sites_of_cell
from orbiframe.delaunay.polygon_fan import cell_triangulation as cell_triangulation
from orbiframe_invariants.closed_geodesics import (
    LengthSpectrum as LengthSpectrum,
    Systole as Systole,
    length_spectrum as length_spectrum,
    systole as systole,
)
from orbiframe.fitting.config import Config as Config
from orbiframe.files.sandbox import confined_read as confined_read, confined_write as confined_write
from orbiframe.triangulations.lost_digits import crowding_of as crowding_of
from orbiframe.delaunay.site_triangulation import (
    SiteTriangulation as SiteTriangulation,
    delaunay as delaunay,
    delaunay_of_vertices as delaunay_of_vertices,
)
from orbiframe.groups.dirichlet_domain import DirichletCell as DirichletCell, dirichlet_cell as dirichlet_cell
from orbiframe.delaunay.domains import domain_for as domain_for
from orbiframe_drawing.file import save_picture as save_picture
from orbiframe_drawing.function_image import lifted as lifted
from orbiframe_drawing.group_picture import draw_group as draw_group, group_picture as group_picture
from orbiframe_drawing.picture import Picture as Picture, beside as beside
from orbiframe_drawing.solid_picture import cut_picture as cut_picture, surface_picture as surface_picture
from orbiframe_drawing.tessellation import Tessellation as Tessellation
from orbiframe_drawing.tessellation_picture import tessellation_picture as tessellation_picture
from orbiframe.splines.element_basis import ElementBasis as ElementBasis
from orbiframe.groups.elements import Elements as Elements, elements_within as elements_within
from orbiframe.errors import (
    ConfigError as ConfigError,
    FitError as FitError,
    FormatError as FormatError,
    GeometryError as GeometryError,
    MapError as MapError,
    OrbiframeError as OrbiframeError,
    PluginError as PluginError,
    TopologyError as TopologyError,
    UsageError as UsageError,
)
from orbiframe.surfaces.triangle_patches import (
    PeriodicPatch as PeriodicPatch,
    QuadrilateralPatches as QuadrilateralPatches,
    TrianglePatches as TrianglePatches,
    patches_of as patches_of,
)
from orbiframe_invariants.exact_relations import prove_relations as prove_relations
from orbiframe.functions.fitter import Fitter as Fitter
from orbiframe.orbifolds.flat_lattice import FlatLattice as FlatLattice
from orbiframe.triangulations.geodesic_triangulation import GeodesicTriangulation as GeodesicTriangulation
from orbiframe_invariants.geodesics import ClosedGeodesic as ClosedGeodesic, Geodesics as Geodesics, Triangles as Triangles
from orbiframe.planes.geometry import Geometry as Geometry
from orbiframe.groups.group import Group as Group
from orbiframe.triangulations.point_location import Locator as Locator
from orbiframe.splines.unknowns import (
    PowellSabinSplit as PowellSabinSplit,
    Unknowns as Unknowns,
    VertexJets as VertexJets,
    edge_normals as edge_normals,
    enclosing_triangles as enclosing_triangles,
    shaped_triangles as shaped_triangles,
)
from orbiframe.groups.marked_group import MarkedGroup as MarkedGroup
from orbiframe.groups.marking import Marking as Marking, marking_along as marking_along
from orbiframe.words.mirror_word import MirrorWord as MirrorWord, Relations as Relations, word_of as word_of
from orbiframe.planes.motion import Motion as Motion
from orbiframe.orbifolds.orbifold import Orbifold as Orbifold
from orbiframe.fitting.pipeline import fit as fit
from orbiframe.plugin import Component as Component, hookimpl as hookimpl
from orbiframe.groups.fundamental_polygon import FundamentalPolygon as FundamentalPolygon, regular_polygon as regular_polygon
from orbiframe.groups.polygon_group import PolygonGroup as PolygonGroup
from orbiframe.meshes.polyhedron import Polyhedron as Polyhedron
from orbiframe.words.presentation import Presentation as Presentation
from orbiframe.planes.quadrature import triangle_points as triangle_points, triangle_rule as triangle_rule
from orbiframe.functions.jet_quotient import divide_jets as divide_jets
from orbiframe.components.registry import Registry as Registry
from orbiframe.functions.samples import Samples as Samples
from orbiframe.splines.shared_edges import along_reference as along_reference, shared_normals as shared_normals
from orbiframe.words.conway_symbol import Signature as Signature
from orbiframe.delaunay.sites import (
    lloyd as lloyd,
    poisson_disc as poisson_disc,
    uniform_points as uniform_points,
    vertex_points as vertex_points,
)
from orbiframe.meshes.edge_paths import (
    Graph as Graph,
    Spacing as Spacing,
    covering_points as covering_points,
    curve_order as curve_order,
    dijkstra_forest as dijkstra_forest,
    edge_graph as edge_graph,
    farthest_points as farthest_points,
    joining_edges as joining_edges,
)
from orbiframe.groups.spherical_group import SphericalGroup as SphericalGroup
from orbiframe.planes.precise_isometry import Spin as Spin
from orbiframe.surfaces.surface import OrbifoldSurface as OrbifoldSurface
from orbiframe.files.surface_file import load_surface as load_surface, save_surface as save_surface
from orbiframe.groups.conway_group import (
    SymmetryGroup as SymmetryGroup,
    orbifold_group as orbifold_group,
    orbifold_of as orbifold_of,
    stabilizer as stabilizer,
)
from orbiframe.groups.mirrored_polygon import SymmetryPolygon as SymmetryPolygon, orbifold_cell as orbifold_cell
from orbiframe.splines.tensor_basis import TensorBasis as TensorBasis
from orbiframe.meshes.surface_type import (
    SurfaceType as SurfaceType,
    doubled_edges as doubled_edges,
    fan_labels as fan_labels,
    reversed_faces as reversed_faces,
    surface_type as surface_type,
)
from orbiframe.triangulations.triangulation import Triangulation as Triangulation
from orbiframe.delaunay.voronoi import cell_areas as cell_areas, circumcentres as circumcentres, circumradii as circumradii
from orbiframe.words.word import Word as Word, standard_word as standard_word
from orbiframe_invariants.word_growth import elements_by_length as elements_by_length, growth_series as growth_series

__version__: str
