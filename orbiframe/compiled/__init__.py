"""Compiled functions: numba, reached through one door.

The decorators are in `decorator.py`. No other folder, and no plugin, imports numba.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
