"""orbiframe area: the area and the total curvature of the smooth surface of a mesh."""

from __future__ import annotations

import argparse
from pathlib import Path

from orbiframe import Registry


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("mesh", metavar="MESH", type=Path, help="one closed surface")
    parser.add_argument("--size", metavar="N", type=int, help="number of functions; default as the shape needs")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Fit the mesh and print two lines."""
    from orbiframe import fit
    from orbiframe.surfaces import SurfaceForms

    surface = fit(args.mesh, registry=registry, progress=args.progress, size=args.size).surface
    print(f"area             {SurfaceForms.of(surface).area:.6g}")
    print(f"total curvature  {surface.total_curvature():.6g}")
    return 0
