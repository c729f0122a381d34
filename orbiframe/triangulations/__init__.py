"""A mesh mapped to X/H, and X/H in geodesic triangles (paper, section 2.4).

Triangulation (`triangulation.py`) and GeodesicTriangulation (`geodesic_triangulation.py`) are the nouns;
`point_location.py` says where a point lies, by `walks.py`.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
