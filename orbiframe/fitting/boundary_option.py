"""Boundary on the command line: what to do with a mesh that is not closed."""

from __future__ import annotations

import argparse

CHOICES = ("error", "cap", "collar", "double", "auto")


def add_boundary(parser: argparse.ArgumentParser) -> None:
    """Add the option that says how a mesh with a boundary is closed for the map."""
    parser.add_argument(
        "--boundary",
        choices=CHOICES,
        help="of an open mesh: how it is closed for the map, where the surface ends with the mesh; auto chooses; "
        "default error (mesh.boundary)",
    )
