"""Tests of the benchmark of quality: all of the long set, and the libraries that they need may be absent."""

from __future__ import annotations

import importlib.util

LIBRARIES = ("igl", "jax", "pymeshlab", "pyvista", "matplotlib")
ABSENT = [name for name in LIBRARIES if importlib.util.find_spec(name) is None]


def pytest_ignore_collect(collection_path, config):
    """Without the long set they are not even collected: importing what they import takes seconds."""
    if collection_path.name.startswith("test_quality_") and (ABSENT or config.option.markexpr == "not long"):
        return True
    return None


def pytest_report_header():
    return f"benchmark of quality not tested without {', '.join(ABSENT)}" if ABSENT else None
