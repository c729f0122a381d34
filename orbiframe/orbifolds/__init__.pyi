"""The public names of orbiframe.orbifolds, each with the module it lives in."""

from .atlas import Atlas as Atlas, Points as Points
from .flat_lattice import FlatLattice as FlatLattice
from .orbifold import Copies as Copies, Orbifold as Orbifold
