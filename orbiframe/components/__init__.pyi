"""The public names of orbiframe.components, each with the module it lives in."""

from .geometry_names import geometry_name as geometry_name
from .registry import Registry as Registry
from .suggestion import did_you_mean as did_you_mean
