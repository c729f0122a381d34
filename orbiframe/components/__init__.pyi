"""The public names of orbiframe.components, each with the module it lives in."""

from .geometry_names import geometry_name as geometry_name
from .options import (
    Option as Option,
    checked_options as checked_options,
    options_of as options_of,
    place_of as place_of,
    require_known as require_known,
)
from .registry import Registry as Registry
from .shown_text import shown as shown
from .suggestion import did_you_mean as did_you_mean
