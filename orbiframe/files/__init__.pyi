"""The public names of orbiframe.files, each with the module it lives in."""

from .datasets import called as called, located as located
from .destination import (
    require_destination as require_destination,
    require_picture as require_picture,
)
from .gate import export as export, read as read, write as write, write_elements as write_elements
from .lock import file_lock as file_lock
from .outputs import (
    output as output,
    require_apart as require_apart,
    require_output as require_output,
    write_bytes as write_bytes,
    write_text as write_text,
)
from .repair_options import add_repairs as add_repairs, repaired as repaired, repairs_asked as repairs_asked
from .sandbox import (
    confined_read as confined_read,
    confined_tables as confined_tables,
    confined_write as confined_write,
)
from .surface_file import load_surface as load_surface, save_surface as save_surface
from .triangles_only import require_triangles as require_triangles
