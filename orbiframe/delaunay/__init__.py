"""Triangulations of X/H with other vertices than those of the mesh: Delaunay, by flips.

`site_triangulation.py` makes one from sites and `spline_domain.py` one for splines; the others are the workshop.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
