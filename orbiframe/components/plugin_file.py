"""Plugin file: one Python file that declares components, imported without being installed."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

LARGEST = 2**24


def imported_file(path: Path) -> ModuleType:
    """The module of a Python file, importable from now on by the stem of its name: "my_basis" for my_basis.py.

    So its targets read "my_basis:MyBasis", as in an installed plugin. Raises FileNotFoundError, or ImportError where
    the name is no Python name or belongs to another module, and whatever the file itself raises.
    """
    _require_usable(path)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise ImportError("a plugin file must end in .py")
    module = sys.modules[path.stem] = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[path.stem]
        raise
    return module


def _require_usable(path: Path) -> None:
    if not path.is_file():
        raise FileNotFoundError("there is no such file")
    if path.stat().st_size > LARGEST:
        raise ImportError(f"it has {path.stat().st_size} bytes, and a plugin file has at most {LARGEST}")
    if not path.stem.isidentifier():
        raise ImportError(f"'{path.stem}' is not a Python name; rename the file")
    home = _home_of(path.stem)
    if home is not None and Path(home).resolve() != path.resolve():
        raise ImportError(f"a module named '{path.stem}' is there already ({home}); rename the file")


def _home_of(name: str) -> str | None:
    present = sys.modules.get(name)
    if present is not None:
        return getattr(present, "__file__", None) or "built in"
    spec = importlib.util.find_spec(name)
    return None if spec is None else spec.origin or "a namespace package"
