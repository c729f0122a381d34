"""Cells of Gmsh: how many nodes each type has, and what it is.

Source: Gmsh Reference Manual, section "Node ordering" and "MSH file format".
"""

from __future__ import annotations

FACES = {2: 3, 3: 4}
BELOW = {1: 2, 8: 3, 26: 4, 27: 5, 28: 6, 62: 7, 15: 1}
SOLIDS = {4: 4, 5: 8, 6: 6, 7: 5, 11: 10, 12: 27, 13: 18, 14: 14, 17: 20, 18: 15, 19: 13, 29: 20, 30: 35, 31: 56,
          92: 64, 93: 125}  # fmt: skip
# Triangles and quadrilaterals of higher order.
CURVED = {9: 6, 10: 9, 16: 8, 20: 9, 21: 10, 22: 12, 23: 15, 24: 15, 25: 21, 36: 16, 37: 25, 38: 36, 39: 12, 40: 16}
SIZES = {**FACES, **BELOW, **SOLIDS, **CURVED}
NAMES = {15: "points", **dict.fromkeys((1, 8, 26, 27, 28, 62), "lines"),
         **dict.fromkeys((4, 11, 29, 30, 31), "tetrahedra"),
         **dict.fromkeys((5, 12, 17, 92, 93), "hexahedra"), **dict.fromkeys((6, 13, 18), "prisms"),
         **dict.fromkeys((7, 14, 19), "pyramids")}  # fmt: skip
