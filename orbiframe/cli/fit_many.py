"""orbiframe fit --into: many meshes, each fitted as if it were alone, by some processes at once."""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from orbiframe.cli.fit import fitted, overrides
from orbiframe.cli.progress import Progress
from orbiframe.cli.report import plain
from orbiframe.cli.speech import say
from orbiframe.components.registry import Registry
from orbiframe.errors import OrbiframeError, UsageError
from orbiframe.files.folder import make_folder
from orbiframe.workers.pool import Outcome, work
from orbiframe.workers.worker_process import COMPILING, Task, Tell

MOST_WORKERS = 1024
# Each of these names one file, and many meshes need many.
_ALONE = ("output", "report", "save")
_KEPT_HERE = ("run", "wrong_use", "progress", "say")


class Job(NamedTuple):
    """A mesh, and the file that its surface goes to."""

    mesh: Path
    output: Path


def run_many(args: argparse.Namespace, registry: Registry) -> int:
    """Fit all meshes; a line for each, and the status is 1 if one could not be fitted."""
    jobs = _jobs(args)
    _require_config(args, registry)
    make_folder(args.into)
    shown = _Shown(args.progress, len(jobs), quiet=args.quiet, as_json=args.json)
    settings = argparse.Namespace(**{name: value for name, value in vars(args).items() if name not in _KEPT_HERE})
    for outcome in work(jobs, fit_task, (settings, registry), workers=min(args.workers, len(jobs)), told=shown.told):
        shown.outcome(outcome)
    return shown.end()


def fit_task(settings: argparse.Namespace, registry: Registry) -> Task:
    """What a process does for each mesh: the whole command, and what is worth a line of it comes back."""

    def task(job: Job, tell: Tell) -> dict[str, Any]:
        own = argparse.Namespace(**vars(settings) | job._asdict() | {"quiet": True})
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("ignore")
            warnings.filterwarnings("always", category=UserWarning)
            report = fitted(own, registry, tell)[0]
        found = {"mesh": str(job.mesh), "file": str(job.output), **plain(report)}
        return {**found, "warnings": [str(each.message) for each in caught]}

    return task


def _jobs(args: argparse.Namespace) -> list[Job]:
    """Every mesh with its file. Raises UsageError for options that name one file, and two files of one name."""
    for name in _ALONE:
        if getattr(args, name) is not None:
            raise UsageError(f"--{name} names one file, and --into makes one for each mesh; leave out one of them")
    if not 1 <= args.workers <= MOST_WORKERS:
        raise UsageError(f"--workers {args.workers}: give 1 to {MOST_WORKERS}")
    suffix = f".{args.to.lstrip('.')}"
    jobs = [Job(mesh, args.into / f"{mesh.stem}{suffix}") for mesh in args.mesh]
    target, count = Counter(job.output for job in jobs).most_common(1)[0]
    if count > 1:
        raise UsageError(f"{count} of the meshes would become {target}; fit them into different folders")
    return jobs


def _require_config(args: argparse.Namespace, registry: Registry) -> None:
    from orbiframe.fitting.config import Config

    Config.load(args.config, overrides(args), registry)


class _Shown:
    """What is said while the meshes are fitted, and at the end."""

    def __init__(self, progress: Progress, total: int, *, quiet: bool, as_json: bool) -> None:
        self._progress, self._total, self._quiet, self._json = progress, total, quiet, as_json
        self._done, self._failed, self._begun = 0, 0, time.monotonic()
        progress.work(0, total)

    def told(self, job: Job, stage: str, seconds: float | None) -> None:
        """Hear of a stage of one fit."""
        if seconds is None or stage == COMPILING:
            count = f" {seconds:.0f} functions, once on this machine" if seconds is not None else ""
            self._work(f"{job.mesh.name}: {stage}{count}")

    def outcome(self, outcome: Outcome) -> None:
        """Say what came of one mesh."""
        self._done += 1
        error = _error_of(outcome)
        if error:
            self._failed += 1
        self._progress.clear()
        if error:
            mesh = str(outcome.item.mesh)
            say(error if mesh in error else f"{mesh}: {error}")
        for line in self._lines(outcome, error):
            print(line, flush=True)
        self._work(outcome.item.mesh.name)

    def end(self) -> int:
        """Say how many could be fitted; the exit status."""
        self._progress.close()
        seconds = time.monotonic() - self._begun
        if not self._quiet and not self._json:
            print(f"{self._done - self._failed} of {self._total} meshes fitted in {seconds:.1f} s")
        return 1 if self._failed else 0

    def _lines(self, outcome: Outcome, error: str) -> Iterator[str]:
        if self._quiet:
            return
        if self._json:
            yield json.dumps({"mesh": str(outcome.item.mesh), "error": error} if error else outcome.result)
            return
        if error:
            return
        report = outcome.result
        fit, seconds = report["fit"], sum(report["seconds"].values())
        yield (
            f"{report['file']}: {fit['size']} functions, rms {fit['rms']:.2e}, max {fit['max']:.2e}, {seconds:.1f} s"
        )
        for note in report["warnings"]:
            say(f"warning: {outcome.item.mesh}: {note}")

    def _work(self, text: str) -> None:
        failed = f"{self._failed} failed" if self._failed else ""
        self._progress.work(self._done, self._total, ", ".join(filter(None, [failed, text])))


def _error_of(outcome: Outcome) -> str:
    """Why there is no result, in a sentence; empty where there is one."""
    if outcome.lost:
        return f"the process that fitted it ended {outcome.lost}, twice; it may need more memory than there is"
    if outcome.error is None:
        return ""
    if isinstance(outcome.error, MemoryError):
        return "not enough memory; take fewer --workers, or a smaller mesh, basis or refinement"
    known = isinstance(outcome.error, OrbiframeError | OSError)
    return str(outcome.error) if known else f"internal error, {type(outcome.error).__name__}: {outcome.error}"
