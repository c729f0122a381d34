"""Three functions on X/H are a surface in space; those of polynomials have exact patches (paper, section 3.4).

OrbifoldSurface (`surface.py`) is the noun.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
