"""The public names of orbiframe.triangulations, each with the module it lives in."""

from .geodesic_triangulation import GeodesicTriangulation as GeodesicTriangulation
from .lost_digits import crowding_of as crowding_of
from .point_location import Location as Location, Locator as Locator
from .triangulation import Triangulation as Triangulation
