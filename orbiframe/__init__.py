"""orbiframe: one truly smooth surface from any closed polyhedron, and function spaces on closed surfaces.

The folders are the paper's chain, from `planes` to `fitting`. The public names are listed in `__init__.pyi`, once, for
Python and for type checkers. Each is imported on first use, so that importing orbiframe loads no numpy.
"""

import lazy_loader

_of_module, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    if name != "__version__":
        return _of_module(name)
    from importlib.metadata import version

    return version("orbiframe")
