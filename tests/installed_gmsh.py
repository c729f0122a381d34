"""Gmsh for tests; where it cannot be loaded, they are skipped with a reason."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from typing import Any

import pytest


def require_gmsh() -> Any:
    """The module of Gmsh, whose library needs libraries of the system."""
    try:
        import gmsh
    except ImportError:
        pytest.skip("Gmsh is not installed: pip install gmsh", allow_module_level=True)
    except OSError as error:
        pytest.skip(f"Gmsh lacks libraries: {error}", allow_module_level=True)
    return gmsh


@pytest.fixture
def signals_kept() -> Iterator[None]:
    """Where Gmsh is used: afterwards a closed connection or Ctrl-C is met as before, and does not end the process."""
    names = [getattr(signal, name) for name in ("SIGINT", "SIGPIPE") if hasattr(signal, name)]
    before = {name: signal.getsignal(name) for name in names}
    yield
    for name, handler in before.items():
        signal.signal(name, handler)
