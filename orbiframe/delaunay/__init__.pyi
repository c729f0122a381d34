"""The public names of orbiframe.delaunay, each with the module it lives in."""

from .crease_domain import crease_triangulation as crease_triangulation, creased as creased
from .crease_sites import Asked as Asked
from .geodesic_edges import Geodesics as Geodesics, edges_along as edges_along, with_edges_along as with_edges_along
from .polygon_fan import polygon_triangulation as polygon_triangulation
from .site_triangulation import (
    SiteTriangulation as SiteTriangulation,
    delaunay as delaunay,
    delaunay_of_vertices as delaunay_of_vertices,
)
from .sites import (
    lloyd as lloyd,
    lloyd_step as lloyd_step,
    poisson_disc as poisson_disc,
    uniform_points as uniform_points,
    vertex_points as vertex_points,
)
from .spline_domain import domain_for as domain_for
from .voronoi import circumcentres as circumcentres, circumradii as circumradii, region_areas as region_areas
