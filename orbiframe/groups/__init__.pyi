"""The public names of orbiframe.groups, each with the module it lives in."""

from .conway_group import (
    ConwayGroup as ConwayGroup,
    orbifold_group as orbifold_group,
    orbifold_of as orbifold_of,
    stabilizer as stabilizer,
)
from .dirichlet_domain import (
    DirichletDomain as DirichletDomain,
    Generators as Generators,
    dirichlet_domain_of as dirichlet_domain_of,
    lettered_pairings as lettered_pairings,
)
from .elements import (
    Elements as Elements,
    elements_of_domain as elements_of_domain,
    elements_within as elements_within,
    grown_elements as grown_elements,
)
from .fundamental_polygon import FundamentalPolygon as FundamentalPolygon, regular_polygon as regular_polygon
from .group import Group as Group
from .marked_group import MarkedGroup as MarkedGroup
from .marking import Marking as Marking, marking_along as marking_along
from .mirrored_polygon import MirroredPolygon as MirroredPolygon, orbifold_polygon as orbifold_polygon
from .polygon_group import PolygonGroup as PolygonGroup
from .spherical_group import SphericalGroup as SphericalGroup
from .spread_points import SpreadPoints as SpreadPoints, spread_over as spread_over
