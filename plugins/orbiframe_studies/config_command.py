"""orbiframe config: configurations and studies explained, for editors, or checked."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from orbiframe import Registry, UsageError

_WHAT = ("init", "schema", "check")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("what", choices=_WHAT, help="init: a commented default; schema: a JSON Schema for editors; check: FILEs")
    add("files", metavar="FILE.toml", type=Path, nargs="*", help="with check: configurations and studies")
    add("-o", "--output", metavar="OUT", type=Path, help="a file for what is made, instead of the standard output")
    add("--study", action="store_true", help="with init: the default of a study, not of a single fit")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Write or check."""
    if args.what == "check":
        return _check(args, registry)
    if args.files:
        raise UsageError(f"config {args.what} takes no files; write it with -o {args.files[0]}")
    text = _template(registry, study=args.study) if args.what == "init" else _schema(registry)
    if args.output is None:
        print(text, end="")
        return 0
    from orbiframe.files import write_text

    write_text(args.output, text)
    return 0


def _template(registry: Registry, *, study: bool) -> str:
    from orbiframe.fitting import config_template
    from orbiframe_studies.study_keys import study_template

    return study_template(registry) if study else config_template(registry)


def _schema(registry: Registry) -> str:
    from orbiframe_studies.study_keys import study_schema

    return json.dumps(study_schema(registry), indent=2, ensure_ascii=False) + "\n"


def _check(args: argparse.Namespace, registry: Registry) -> int:
    """Say of every file whether it can be used; raises what is wrong with the first that cannot."""
    from orbiframe import Config
    from orbiframe.fitting import read_tables
    from orbiframe_studies.plan import Plan
    from orbiframe_studies.study_file import read_study

    if not args.files:
        raise UsageError("config check needs a FILE.toml, or several")
    for path in args.files:
        if "study" in read_tables(path)[0]:
            plan = Plan(read_study(path), registry)
            most = "at most " if plan.varies else ""
            print(f"{path}: a study of {most}{plan.expected} fits")
        else:
            Config.load(path, (), registry)
            print(f"{path}: a configuration")
    return 0
