"""orbiframe convert: meshes in another format, repaired where that is asked for."""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path
from typing import Any

from orbiframe.cli.losses import losses
from orbiframe.cli.speech import say
from orbiframe.cli.streams import STREAM, choice, read, write
from orbiframe.components.registry import Registry
from orbiframe.errors import FormatError, OrbiframeError, UsageError
from orbiframe.files.destination import require_destination
from orbiframe.files.outputs import require_apart
from orbiframe.files.repair_options import add_repairs, repaired


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("files", metavar="FILE", type=Path, nargs="+", help="IN OUT, with - for a stream; with --to, meshes to read")
    add("-i", "--input-format", metavar="FORMAT", help="name or suffix of a reader, instead of the suffix of IN")
    add("-o", "--output-format", metavar="FORMAT", help="name or suffix of a writer, instead of the suffix of OUT")
    add("--to", metavar="SUFFIX", help="write every FILE with this suffix instead of its own")
    add("--into", metavar="DIR", type=Path, help="the folder for the files of --to, instead of their own")
    add("--ascii", action="store_true", help="text where the format is else binary (writer.ascii=true)")
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help="an option of the reader or the writer")
    add("--strict", action="store_true", help="an error instead of a warning for what the format cannot hold")
    add_repairs(parser)
    parser.set_defaults(run=run, wrong_use=parser.error)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Read, repair and write; of several files, those that can be: the status is 1 if one cannot."""
    options = _options(args)
    if args.to is None:
        _convert(*_pair(args), args, options, registry)
        return 0
    targets = _targets(args, registry)
    done = sum(_attempted(*pair, args, options, registry) for pair in zip(args.files, targets, strict=True))
    print(f"{done} of {len(targets)} files converted")
    return 0 if done == len(targets) else 1


def _pair(args: argparse.Namespace) -> tuple[Path, Path]:
    if args.into is not None:
        args.wrong_use("--into needs --to with the suffix of the files to make, such as --to ply")
    if len(args.files) != 2:
        args.wrong_use("give IN and OUT, or --to with a suffix for any number of meshes")
    return args.files[0], args.files[1]


def _targets(args: argparse.Namespace, registry: Registry) -> list[Path]:
    """The files to make. Raises UsageError if two would be the same, or one is an input."""
    suffix = f".{args.to.lstrip('.')}"
    if STREAM in args.files:
        raise UsageError("--to needs files with names; for - give IN and OUT")
    targets = [(args.into or path.parent) / path.with_suffix(suffix).name for path in args.files]
    for target, count in Counter(targets).items():
        if count > 1:
            raise UsageError(f"{count} of the files would become {target}; convert them into different folders")
    if args.into is not None:
        _make_folder(args.into)
    for target in targets:
        require_destination(target, registry, choice("writer", args.output_format, registry).component)
        for path in args.files:
            require_apart({"the output": target}, {"the input": path})
    return targets


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise FormatError(f"the folder {folder} cannot be made: {error.strerror}; name another one") from error


def _attempted(source: Path, target: Path, args: argparse.Namespace, options: Any, registry: Registry) -> bool:
    """Convert one file of several; what stops it is said."""
    try:
        _convert(source, target, args, options, registry, title=f"{source}: ")
    except (OrbiframeError, OSError, MemoryError) as error:
        said = str(error) or "not enough memory"
        say(said if str(source) in said else f"{source}: {said}")
        return False
    return True


def _convert(
    source: Path, target: Path, args: argparse.Namespace, options: Any, registry: Registry, title: str = ""
) -> None:
    chosen = choice("writer", args.output_format, registry)
    if target != STREAM:
        require_destination(target, registry, chosen.component)
        require_apart({"the output": target}, {"the input": source})
    with losses(strict=args.strict):
        polyhedron = read(
            source, registry, args.input_format, options=options["reader"], degenerate=args.drop_degenerate
        )
        polyhedron = repaired(polyhedron, args, say, title=title)
        write(target, polyhedron, registry, args.output_format, options=options["writer"])


def _options(args: argparse.Namespace) -> dict[str, dict[str, Any]]:
    """The options of the reader and of the writer."""
    from orbiframe.fitting.config_text import parsed_override, require_table

    tables: dict[str, dict[str, Any]] = {"reader": {}, "writer": {"ascii": True} if args.ascii else {}}
    for text in args.set:
        table, key, value = parsed_override(text)
        require_table(table, tuple(tables), {table: f"--set {text}"})
        tables[table][key] = value
    return tables
