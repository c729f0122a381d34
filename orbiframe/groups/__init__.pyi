"""The public names of orbiframe.groups, each with the module it lives in."""

from .conway_group import (
    SymmetryGroup as SymmetryGroup,
    orbifold_group as orbifold_group,
    orbifold_of as orbifold_of,
    stabilizer as stabilizer,
)
from .dirichlet_domain import (
    DirichletCell as DirichletCell,
    Generators as Generators,
    dirichlet_cell as dirichlet_cell,
    lettered_pairings as lettered_pairings,
)
from .elements import (
    Elements as Elements,
    cell_elements as cell_elements,
    elements_within as elements_within,
    grown_elements as grown_elements,
)
from .fundamental_polygon import FundamentalPolygon as FundamentalPolygon, regular_polygon as regular_polygon
from .group import Group as Group
from .marked_group import MarkedGroup as MarkedGroup
from .marking import Marking as Marking, marking_along as marking_along
from .mirrored_polygon import SymmetryPolygon as SymmetryPolygon, orbifold_cell as orbifold_cell
from .polygon_group import PolygonGroup as PolygonGroup
from .spherical_group import SphericalGroup as SphericalGroup
from .spread_points import CellSites as CellSites, sites_of_cell as sites_of_cell
