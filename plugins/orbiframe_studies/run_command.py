"""orbiframe run: all fits of a study file, in a folder that remembers them."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from orbiframe import Registry, UsageError

if TYPE_CHECKING:
    from orbiframe_studies.plan import Plan

MOST_WORKERS = 1024


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("study", metavar="STUDY.toml", type=Path, help="meshes, a configuration, and what is varied")
    add("--into", metavar="DIR", type=Path, help="the folder of the study; default: its file without .toml")
    add("--workers", metavar="N", type=int, help="processes at once; default: one for each processor")
    add("--scheduler", metavar="ADDRESS", help="a dask scheduler, such as tcp://head:8786, or 'local'")
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help="one option of all fits")
    add("--retry", action="store_true", help="do fits again that have failed")
    add("--plan", action="store_true", help="check the study and say what it would do, and do nothing")
    add("--json", action="store_true", help="print one JSON object instead of the summary")
    add("--quiet", action="store_true", help="print nothing but errors")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Run the study; the status is 1 if a fit has failed."""
    from orbiframe.workers import processors
    from orbiframe_studies.plan import Plan
    from orbiframe_studies.runner import Hands, processes, run_study, told
    from orbiframe_studies.study_file import read_study
    from orbiframe_studies.study_folder import opened

    if args.workers is not None and not 1 <= args.workers <= MOST_WORKERS:
        raise UsageError(f"--workers {args.workers}: give 1 to {MOST_WORKERS}")
    study = read_study(args.study, args.set)
    plan = Plan(study, registry)
    _require_libraries(study.settings.keep)
    if args.plan:
        print("\n".join(_planned(plan)))
        return 0
    workers = min(args.workers or processors(), max(plan.expected, 1))
    hands: Hands = processes(workers)
    if args.scheduler is not None:
        from orbiframe_studies.dask_hands import dask_hands

        hands = dask_hands(args.scheduler, workers)
    into = args.into or args.study.with_suffix("")
    with opened(into, study.name, args.study) as folder:
        try:
            summary = run_study(study, plan, folder, hands, args.progress, retry=args.retry)
        except KeyboardInterrupt as error:
            raise KeyboardInterrupt("interrupted; the same command goes on where this one stopped") from error
    if args.json:
        print(json.dumps({"folder": str(into), **asdict(summary)}))
    elif not args.quiet:
        print("\n".join(told(summary, into)))
    return 1 if summary.failed or summary.lost else 0


def _require_libraries(keep: tuple[str, ...]) -> None:
    if "arrays" in keep:
        from orbiframe_studies.arrays import require_arrays

        require_arrays()


def _planned(plan: Plan) -> list[str]:
    study, most = plan.study, "at most " if plan.varies else ""
    lines = [
        f"study     {study.name}, {most}{plan.expected} fits",
        f"meshes    {len(study.meshes)}",
    ]
    lines += [f"cases     {', '.join(case.name for case in study.cases)}"] if study.cases else []
    lines += [f"sweep     {name} = {', '.join(map(str, values))}" for name, values in study.sweep.items()]
    lines += [f"seeds     {', '.join(map(str, study.settings.seeds))}"] if study.settings.seeds else []
    return lines
