"""Polyhedra in space: what they are, what is wrong with them, how they are mended and made finer.

Polyhedron (`polyhedron.py`) and its `surface_type.py` are the nouns; everything else is the workshop behind them.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
