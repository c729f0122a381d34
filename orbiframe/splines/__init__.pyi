"""The public names of orbiframe.splines, each with the module it lives in."""

from .bernstein import (
    bernstein_values as bernstein_values,
    blossom as blossom,
    coefficient_count as coefficient_count,
    exponents as exponents,
    polar as polar,
    symmetric_power as symmetric_power,
)
from .element_basis import ElementBasis as ElementBasis
from .galerkin import integrals as integrals, mass as mass, stiffness as stiffness
from .hairs import HairPoints as HairPoints, hair_points as hair_points
from .powell_sabin_split import PowellSabinSplit as PowellSabinSplit
from .sectors import Sectors as Sectors
from .shared_edges import (
    along_reference as along_reference,
    edge_normals as edge_normals,
    shared_normals as shared_normals,
)
from .tensor_basis import TensorBasis as TensorBasis
from .unknowns import Unknowns as Unknowns
from .vertex_jets import (
    VertexJets as VertexJets,
    enclosing_triangles as enclosing_triangles,
    shaped_triangles as shaped_triangles,
)
