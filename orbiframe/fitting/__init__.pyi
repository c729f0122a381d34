"""The public names of orbiframe.fitting, each with the module it lives in."""

from .boundary_option import add_boundary as add_boundary
from .config import Config as Config
from .config_text import (
    Overrides as Overrides,
    override_items as override_items,
    read_tables as read_tables,
    require_table as require_table,
    table_of as table_of,
)
from .content import content_key as content_key, file_key as file_key, source_key as source_key
from .kept_maps import KeptMaps as KeptMaps
from .keys import ConfigKey as ConfigKey, config_keys as config_keys
from .parts import Parts as Parts, fit_parts as fit_parts
from .pipeline import Result as Result, fit as fit
from .report import versions as versions
from .schema import config_schema as config_schema
from .template import config_template as config_template, toml_value as toml_value
from .written_config import config_toml as config_toml, tables_of as tables_of
