"""The public names of orbiframe.planes, each with the module it lives in."""

from .geometry import Geometry as Geometry
from .motion import Motion as Motion
from .precise_isometry import PreciseIsometry as PreciseIsometry
from .quadrature import triangle_points as triangle_points, triangle_rule as triangle_rule
