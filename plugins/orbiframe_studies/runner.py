"""Runner: does what is not done yet of a study, and writes its table."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from orbiframe import FormatError, OrbiframeError, Registry
from orbiframe.workers import COMPILING, Outcome, work
from orbiframe_studies.journal import Journal
from orbiframe_studies.machine import git_state
from orbiframe_studies.one_fit import Terms, fit_task
from orbiframe_studies.plan import Fit, Plan
from orbiframe_studies.source import Source
from orbiframe_studies.study import Study
from orbiframe_studies.study_folder import StudyFolder
from orbiframe_studies.table import write_tables

Entry = dict[str, Any]
_GB = 10**9
Told = Callable[[Fit, str, float | None], None]


class Progress(Protocol):
    """Whoever is told how far a study is."""

    def work(self, done: int, total: int, text: str = "") -> None:
        """So many of so many fits are done."""


class Hands(Protocol):
    """Whoever does fits: processes of this machine, or a cluster."""

    def __call__(self, fits: Source, registry: Registry, terms: Terms, told: Told) -> Iterable[Outcome]:
        """The outcome of every fit, in any order."""


@dataclass(frozen=True, slots=True)
class Summary:
    """What a run of a study did.

    fits: of the whole study, and how many of them are done, failed and lost (their process died, or there was too
    little memory: they are tried again); new: how many were done now; maps: computed now; peak: the most bytes that one
    process took; damaged: lines of the journal that were no entries.
    """

    fits: int
    done: int
    failed: int
    lost: int
    new: int
    maps: int
    peak: int
    damaged: int
    seconds: float


def processes(count: int) -> Hands:
    """Fits by so many processes of this machine; by this one for 1, unless their memory is limited."""

    def hands(fits: Source, registry: Registry, terms: Terms, told: Told) -> Iterator[Outcome]:
        memory = None if terms.memory is None else round(terms.memory * _GB)
        yield from work(fits, fit_task, (registry, terms), workers=count, memory=memory, told=told)

    return hands


def run_study(
    study: Study, plan: Plan, folder: StudyFolder, hands: Hands, progress: Progress, *, retry: bool = False
) -> Summary:
    """Do all fits that are not done yet, and write the table; also if it is interrupted on the way.

    retry: those that have failed too. Raises FormatError where results cannot be written.
    """
    begun = time.perf_counter()
    with Journal(folder.journal) as journal:
        _forget(journal, retry)
        running = _Running(study, plan, journal, progress)
        settings = study.settings
        maps = settings.maps == "kept" or (settings.maps == "auto" and plan.fits_per_mesh > 1)
        terms = Terms(folder.path.absolute(), settings.noise, settings.keep, maps, settings.memory)
        try:
            for outcome in hands(running.source, plan.registry, terms, running.told):
                running.take(outcome)
        finally:
            running.source.close()
            counts = write_tables(plan, journal, folder)
        new = {"new": running.new, "maps": running.maps, "peak": running.peak, "damaged": journal.damaged}
        return Summary(**counts, **new, seconds=round(time.perf_counter() - begun, 2))


def _forget(journal: Journal, retry: bool) -> None:
    """Let fits be done again whose process died, and if wanted those that failed."""
    again = ("lost", "failed") if retry else ("lost",)
    for key in [key for key in journal.keys() if journal.status(key) in again]:  # noqa: SIM118
        journal.forget(key)


class _Running:
    """What has come out so far."""

    def __init__(self, study: Study, plan: Plan, journal: Journal, progress: Progress) -> None:
        self._plan, self._journal, self._progress = plan, journal, progress
        self._git = git_state(study.file.parent)
        self._failed = 0
        self.new, self.maps, self.peak = 0, 0, 0
        self.source = Source(plan.chains(), journal.get)
        self._show("")

    def told(self, fit: Fit, stage: str, seconds: float | None) -> None:
        """Hear of a stage of one fit."""
        if seconds is None:
            self._show(f"{fit.title}: {stage}")
        elif stage == COMPILING:
            self._show(f"compiling, once on a machine: {seconds:.0f} functions so far")

    def take(self, outcome: Outcome) -> None:
        """Write down what came of one fit. Raises what stops the study."""
        entry = _entry(outcome)
        entry["timing"]["git"] = self._git
        self._journal.add(entry)
        self.new += 1
        self._failed += entry["status"] != "done"
        self.maps += entry["timing"].get("maps_computed", 0)
        self.peak = max(self.peak, entry["timing"].get("peak", 0))
        self.source.put(outcome.item.key, entry)
        self._show(outcome.item.title)

    def _show(self, text: str) -> None:
        failed = f"{self._failed} failed" if self._failed else ""
        done, total = self.source.rows, self.source.rows + self._plan.chain_length * self._open_chains()
        self._progress.work(done, max(total, done), ", ".join(filter(None, [failed, text])))

    def _open_chains(self) -> int:
        return self._plan.chain_count - self.source.ended


def _entry(outcome: Outcome) -> Entry:
    """The entry of an outcome; raises an error that is none of the fit."""
    if outcome.lost:
        text = f"the process that did it ended {outcome.lost}; it is tried again when the study is run again"
        error = {"type": "Lost", "text": text}
        return {"key": outcome.item.key, "status": "lost", "error": error, "timing": {}}
    if isinstance(outcome.error, OrbiframeError | OSError):
        raise outcome.error
    if outcome.error is not None:
        name = type(outcome.error).__name__
        raise FormatError(f"{outcome.item.title}: what it gave cannot be kept ({name}: {outcome.error})")
    entry: Entry = outcome.result
    return entry


def told(summary: Summary, folder: Path) -> Iterator[str]:
    """A summary in lines."""
    parts = [f"{summary.done} done"]
    parts += [f"{summary.failed} failed"] if summary.failed else []
    parts += [f"{summary.lost} lost, to be tried again"] if summary.lost else []
    yield f"fits      {summary.fits}: {', '.join(parts)}; {summary.new} of them now, in {summary.seconds:.1f} s"
    if summary.new:
        peak = f"at most {summary.peak / 1e6:.0f} MB in one process" if summary.peak else "memory unknown"
        yield f"cost      {summary.maps} maps computed, {peak}"
    if summary.damaged:
        yield f"journal   {summary.damaged} damaged lines were passed over, and their fits done again"
    yield f"folder    {folder}"
