"""The planes X: the sphere, the Euclidean and the hyperbolic plane (paper, section 1).

Geometry (`geometry.py`) is the noun; `motion.py` names what an isometry does, `quadrature.py` integrates,
`precise_isometry.py` keeps long products of isometries exact.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
