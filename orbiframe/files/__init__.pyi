"""The public names of orbiframe.files, each with the module it lives in."""

from .destination import (
    require_destination as require_destination,
    require_folder as require_folder,
    require_other_file as require_other_file,
    require_picture as require_picture,
)
from .gate import export as export, read as read, write as write
from .sandbox import confined_read as confined_read, confined_write as confined_write
from .surface_file import load_surface as load_surface, save_surface as save_surface
