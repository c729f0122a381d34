"""Benchmarks are not installed: their folder goes on the path, and what they need beyond the package may be absent."""

from __future__ import annotations

import importlib.util
import sys

from documents import ROOT

LIBRARIES = ("igl", "jax", "pymeshlab", "pyvista", "matplotlib")
ABSENT = [name for name in LIBRARIES if importlib.util.find_spec(name) is None]
collect_ignore_glob = ["test_quality_*.py"] if ABSENT else []

sys.path.append(str(ROOT / "benchmarks"))
