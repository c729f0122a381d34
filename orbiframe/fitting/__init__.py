"""The one arrow: from a mesh to a surface (paper, section 3.4).

`pipeline.py` is the arrow, `config.py` what it is told and `report.py` what it says.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
