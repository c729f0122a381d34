"""The public names of orbiframe, each with the module it lives in."""

from .components.registry import Registry as Registry
from .errors import (
    ConfigError as ConfigError,
    FitError as FitError,
    FormatError as FormatError,
    GeometryError as GeometryError,
    MapError as MapError,
    Notice as Notice,
    OrbiframeError as OrbiframeError,
    PluginError as PluginError,
    TopologyError as TopologyError,
    UsageError as UsageError,
)
from .files.gate import read as read, write as write
from .files.surface_file import load_surface as load_surface, save_surface as save_surface
from .fitting.config import Config as Config
from .fitting.pipeline import fit as fit
from .functions.basis import Basis as Basis, DifferentiableBasis as DifferentiableBasis
from .functions.fitter import Fitter as Fitter
from .functions.samples import Samples as Samples
from .groups.fundamental_polygon import FundamentalPolygon as FundamentalPolygon
from .groups.group import Group as Group
from .groups.marking import Marking as Marking
from .meshes.polyhedron import Polyhedron as Polyhedron
from .meshes.surface_type import SurfaceType as SurfaceType, surface_type as surface_type
from .orbifolds.atlas import Atlas as Atlas, Points as Points
from .orbifolds.orbifold import Orbifold as Orbifold
from .planes.geometry import Geometry as Geometry
from .plugin import Component as Component, hookimpl as hookimpl
from .surfaces.surface import OrbifoldSurface as OrbifoldSurface
from .triangulations.triangulation import Triangulation as Triangulation
from .words.word import Word as Word

__version__: str
