"""Functions on X/H: bases, orbit sums, samples and fitters (paper, section 3).

Basis (`basis.py`), Samples (`samples.py`) and Fitter (`fitter.py`) are the nouns; the paper's basis is in
`orbit_sum_basis.py`.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
