"""orbiframe: one truly smooth surface from any closed polyhedron, and function spaces on closed surfaces.

The public names and their homes are listed in `__init__.pyi`, once, for Python and for type checkers. Each is imported
on first use, so that importing orbiframe loads no numpy.
"""

import ast
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType


def _homes() -> dict[str, str]:
    """The module of every public name."""
    listed = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")).body
    imports = [node for node in listed if isinstance(node, ast.ImportFrom)]
    return {alias.name: str(node.module) for node in imports for alias in node.names}


_HOME = _homes()

__all__ = sorted(_HOME)


def __getattr__(name: str) -> object:
    if name not in _HOME and name != "__version__":
        raise AttributeError(f"module 'orbiframe' has no attribute '{name}'")
    value = globals()[name] = _version() if name == "__version__" else getattr(import_module(_HOME[name]), name)
    return value


class _Facade(ModuleType):
    """The package, whose public names stay what they are where a module of the same name is imported."""

    def __setattr__(self, name: str, value: object) -> None:
        if not (isinstance(value, ModuleType) and name in _HOME):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Facade


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


def _version() -> str:
    from importlib.metadata import version

    return version("orbiframe")
