"""Piecewise polynomials on X/H: one sparse matrix from unknowns to homogeneous Bernstein coefficients.

ElementBasis (`element_basis.py`) is the noun; the others build its matrix and integrate.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
