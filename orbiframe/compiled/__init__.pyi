"""The public names of orbiframe.compiled, each with the module it lives in."""

from .decorator import compiled as compiled
