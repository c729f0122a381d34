"""Discrete groups H with a fundamental polygon, or marked by a mesh (paper, section 2).

Group (`group.py`), FundamentalPolygon (`fundamental_polygon.py`) and Marking (`marking.py`) are the nouns; the others
make groups and enumerate them.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
