"""orbiframe convert: a mesh in another format."""

from __future__ import annotations

import argparse
from pathlib import Path

from orbiframe.cli.destination import require_destination, require_other_file
from orbiframe.registry import Registry


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("input", metavar="IN", type=Path, help="the mesh to read")
    parser.add_argument("output", metavar="OUT", type=Path, help="the mesh to write")
    parser.add_argument("-i", "--input-format", metavar="FORMAT", help="name of a reader, instead of the suffix of IN")
    parser.add_argument(
        "-o", "--output-format", metavar="FORMAT", help="name of a writer, instead of the suffix of OUT"
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Read one file and write the other."""
    from orbiframe import formats

    require_destination(args.output, registry, args.output_format)
    require_other_file(args.output, args.input)
    polyhedron = formats.read(args.input, registry, format=args.input_format)
    formats.write(args.output, polyhedron, registry, format=args.output_format)
    return 0
