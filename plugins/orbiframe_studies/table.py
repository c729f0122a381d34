"""Table: a line of JSON for every fit of a study, in its order, whatever order they were done in."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from orbiframe.files import output
from orbiframe_studies.journal import Journal
from orbiframe_studies.plan import Fit, Plan
from orbiframe_studies.study_folder import StudyFolder

Row = dict[str, Any]


def write_tables(plan: Plan, journal: Journal, folder: StudyFolder) -> dict[str, int]:
    """Write the table of values and that of times, of all fits that are done; returns how many have which status."""
    counts: Counter[str] = Counter()
    with _file(folder.table) as table, _file(folder.timings) as timings:
        for number, (fit, entry) in enumerate(ended(plan, journal)):
            counts[entry["status"]] += 1
            _write(table, row(number, fit, entry))
            _write(timings, {"run": number, "key": fit.key, **entry["timing"]})
        if not counts:  # an empty file is none
            table.write("\n")
            timings.write("\n")
    return {"fits": plan.expected if not plan.varies else counts.total(), **{s: counts[s] for s in _STATES}}


_STATES = ("done", "failed", "lost")


def ended(plan: Plan, journal: Journal) -> Iterator[tuple[Fit, Row]]:
    """The fits of all chains in the order of the study, as far as they are done, each with its entry."""
    for chain in plan.chains():
        fits = next(chain, [])
        while fits:
            entries = [journal.get(fit.key) for fit in fits]
            yield from ((fit, entry) for fit, entry in zip(fits, entries, strict=True) if entry is not None)
            if any(entry is None for entry in entries):
                break
            try:
                fits = chain.send([entry for entry in entries if entry is not None])
            except StopIteration:
                break


def row(number: int, fit: Fit, entry: Row) -> Row:
    """A line of the table: what names the fit, what was chosen for it, and what came out."""
    return {
        "run": number,
        "mesh": fit.name,
        "case": fit.case,
        "seed": fit.seed,
        "parameters": dict(fit.parameters),
        "key": fit.key,
        "status": entry["status"],
        "error": entry["error"],
        "warnings": entry.get("warnings", []),
        "report": entry.get("report"),
    }


@contextmanager
def _file(path: Path) -> Iterator[IO[str]]:
    with output(path) as made, made.open("w", encoding="utf-8") as file:
        yield file


def _write(file: IO[str], content: Row) -> None:
    file.write(json.dumps(content, allow_nan=False) + "\n")
