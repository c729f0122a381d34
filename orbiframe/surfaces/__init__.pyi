"""The public names of orbiframe.surfaces, each with the module it lives in."""

from .exact_patches import patches_of as patches_of
from .periodic_patch import PeriodicPatch as PeriodicPatch
from .quadrilateral_patches import QuadrilateralPatches as QuadrilateralPatches
from .surface import Curvature as Curvature, OrbifoldSurface as OrbifoldSurface
from .triangle_patches import TrianglePatches as TrianglePatches
