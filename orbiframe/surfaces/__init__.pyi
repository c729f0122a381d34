"""The public names of orbiframe.surfaces, each with the module it lives in."""

from .border import inside as inside
from .border_curve import BorderCurve as BorderCurve, border_curves as border_curves
from .border_pieces import BorderPieces as BorderPieces, even_pieces as even_pieces
from .colour_scale import ColourScale as ColourScale
from .complex_structure import PeriodMatrix as PeriodMatrix, period_matrix as period_matrix
from .curved_edges import edge_curves as edge_curves
from .curved_triangles import (
    CurvedMesh as CurvedMesh,
    curved_mesh as curved_mesh,
    joined_meshes as joined_meshes,
    node_exponents as node_exponents,
)
from .distance_along_surface import GeodesicDistance as GeodesicDistance, geodesic_distance as geodesic_distance
from .equations import biharmonic as biharmonic, heat as heat, poisson as poisson
from .exact_patches import patches_of as patches_of
from .field import Field as Field, fit_field as fit_field
from .for_jax import jax_surface as jax_surface
from .for_torch import torch_surface as torch_surface
from .geodesic_faces import GeodesicFaces as GeodesicFaces, input_faces as input_faces
from .gram_schmidt import Orthonormal as Orthonormal, orthonormal as orthonormal
from .harmonic_forms import HarmonicForms as HarmonicForms
from .hodge import Decomposition as Decomposition, Hodge as Hodge
from .nearest import nearest_points as nearest_points
from .operator import SurfaceOperator as SurfaceOperator
from .periodic_patch import PeriodicPatch as PeriodicPatch
from .principal import (
    PrincipalCurvature as PrincipalCurvature,
    principal_curvature as principal_curvature,
)
from .quadrilateral_patches import QuadrilateralPatches as QuadrilateralPatches
from .scattering import map_areas as map_areas, scattered_points as scattered_points
from .shaded_mesh import ShadedPicture as ShadedPicture, shaded_picture as shaded_picture
from .signatures import (
    heat_kernel as heat_kernel,
    heat_kernel_signature as heat_kernel_signature,
    wave_kernel_signature as wave_kernel_signature,
)
from .surface import Curvature as Curvature, OrbifoldSurface as OrbifoldSurface, Tessellation as Tessellation
from .surface_forms import SurfaceForms as SurfaceForms
from .surface_spectrum import Spectrum as Spectrum, spectrum as spectrum
from .textures import (
    TextureDistortion as TextureDistortion,
    texture_coordinates as texture_coordinates,
    texture_distortion as texture_distortion,
)
from .triangle_patches import TrianglePatches as TrianglePatches
from .values_to_show import ShownValues as ShownValues, shown_values as shown_values
from .whitney_form import edge_form as edge_form
from .within_border import (
    OpenTriangulation as OpenTriangulation,
    edge_for as edge_for,
    open_triangulation as open_triangulation,
)
