"""Orbifolds X/H as atlases of patches, so that numbers live near the origin.

Atlas (`atlas.py`) and Orbifold (`orbifold.py`) are the nouns; `flat_lattice.py` serves tori and Klein bottles.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
