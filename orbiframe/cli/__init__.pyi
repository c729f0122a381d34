"""The public names of orbiframe.cli, each with the module it lives in."""

from .boundary import add_boundary as add_boundary
from .progress import Progress as Progress
