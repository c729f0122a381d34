"""orbiframe completion: what a shell needs to complete commands, options and names of files."""

from __future__ import annotations

import argparse
from pathlib import Path

from orbiframe.components.registry import Registry
from orbiframe.errors import PluginError

SHELLS = ("bash", "zsh", "tcsh")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("shell", choices=SHELLS, help="which shell; what is printed is for its completions")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Print the script."""
    try:
        import shtab
    except ImportError as error:
        raise PluginError('completion needs the package shtab: pip install "orbiframe[completion]"') from error
    from orbiframe.cli.main import whole_parser

    parser = whole_parser(registry)
    _complete_files(parser, shtab.FILE)
    print(shtab.complete(parser, args.shell))
    return 0


def _complete_files(parser: argparse.ArgumentParser, files: object) -> None:
    """Say of every argument that is a path, in all parts of a command, that files are its values."""
    for action in parser._actions:
        if action.type is Path:
            action.complete = files  # type: ignore[attr-defined]
        if isinstance(action, argparse._SubParsersAction):
            for part in dict.fromkeys(action.choices.values()):
                _complete_files(part, files)
