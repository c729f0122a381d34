"""Modules that are imported when a test first asks for something in them, so that collecting tests is quick."""

from __future__ import annotations

from functools import cached_property
from importlib import import_module
from types import ModuleType

import pytest


class Late:
    """A module by its name, imported at the first use of a name in it.

    needs: a library from outside that the module cannot be without, by default the module itself. Where that is absent,
    or cannot be loaded because the system lacks a library of its own, the test that asks is skipped with the reason.
    Errors of other modules are errors.
    """

    def __init__(self, module: str, needs: str | None = None) -> None:
        self._name, self._needs = module, needs or module

    @cached_property
    def _module(self) -> ModuleType:
        require(self._needs)
        return import_module(self._name)

    def __getattr__(self, name: str) -> object:
        if name.startswith("_"):  # pytest and unittest ask every name of a file for marks of their own
            raise AttributeError(name)
        return getattr(self._module, name)


def require(library: str) -> None:
    """Skip the test where a library is absent or cannot be loaded."""
    try:
        import_module(library)
    except (ImportError, OSError) as error:
        pytest.skip(f"{library} cannot be imported here: {error}")
