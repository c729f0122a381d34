"""Gmsh for tests; where it cannot be loaded, they are skipped with a reason."""

from __future__ import annotations

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
