"""Words: gluings of the sides of a polygon, and Conway's symbols (paper, section 2.1).

Word (`word.py`) is the noun; the others describe groups by words.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
