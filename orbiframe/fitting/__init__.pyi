"""The public names of orbiframe.fitting, each with the module it lives in."""

from .config import Config as Config
from .parts import fit_parts as fit_parts
from .pipeline import fit as fit
