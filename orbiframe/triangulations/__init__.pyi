"""The public names of orbiframe.triangulations, each with the module it lives in."""

from .cocycles import (
    cohomology as cohomology,
    intersections as intersections,
    refined_jumps as refined_jumps,
)
from .cut_open import Unrolled as Unrolled, unrolled as unrolled
from .geodesic_triangulation import GeodesicTriangulation as GeodesicTriangulation
from .local_girth import Girth as Girth, girth as girth, site_density as site_density, site_lengths as site_lengths
from .lost_digits import crowding_of as crowding_of
from .point_location import Location as Location, Locator as Locator
from .tessellation import (
    FaceCopies as FaceCopies,
    LiftedFaces as LiftedFaces,
    Tessellation as Tessellation,
    geodesic_sides as geodesic_sides,
)
from .triangulation import Triangulation as Triangulation
