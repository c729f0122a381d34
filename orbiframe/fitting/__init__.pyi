"""The public names of orbiframe.fitting, each with the module it lives in."""

from .config import Config as Config
from .pipeline import fit as fit
