"""The public names of orbiframe.cli, each with the module it lives in."""

from .progress import Progress as Progress
