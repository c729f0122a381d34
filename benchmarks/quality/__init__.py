"""Surfaces from meshes, compared: shapes, truths, methods, measures, tables. `python benchmarks/quality.py` runs it."""
