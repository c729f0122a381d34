"""The public names of orbiframe.surfaces, each with the module it lives in."""

from .curved_triangles import (
    CurvedMesh as CurvedMesh,
    curved_mesh as curved_mesh,
    joined_meshes as joined_meshes,
    node_exponents as node_exponents,
)
from .exact_patches import patches_of as patches_of
from .geodesic_faces import GeodesicFaces as GeodesicFaces, input_faces as input_faces
from .periodic_patch import PeriodicPatch as PeriodicPatch
from .quadrilateral_patches import QuadrilateralPatches as QuadrilateralPatches
from .surface import Curvature as Curvature, OrbifoldSurface as OrbifoldSurface
from .triangle_patches import TrianglePatches as TrianglePatches
