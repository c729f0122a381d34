"""orbiframe report: one page of HTML that shows a study."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe import FormatError, Registry

if TYPE_CHECKING:
    from orbiframe_studies.results import Results

_MOST_PICTURES, _MOST_BARS, _MOST_ROWS = 24, 60, 20_000


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("study", metavar="STUDY", type=Path, help="the folder of a study, or its file")
    add("-o", "--output", metavar="OUT.html", type=Path, help="the page; default: report.html in the folder")
    add("--measure", metavar="NAME", default="fit.rms", help="the error: fit.rms, which is the default, or fit.max")
    add("--quiet", action="store_true", help="print nothing but errors")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, _: Registry) -> int:
    """Write the page, and say what the orders are."""
    from orbiframe.files import require_output, write_text
    from orbiframe_studies.orders import series_of
    from orbiframe_studies.page import page
    from orbiframe_studies.results import Results
    from orbiframe_studies.study import require_measure

    require_measure(args.measure)
    results = Results.of(args.study)
    target = args.output or results.folder.path / "report.html"
    require_output(target)
    rows, timings = list(results.rows()), list(results.timings())
    if not rows:
        raise FormatError(f"{results.folder.path}: no fit of the study is done yet; run it first")
    series = series_of(rows, args.measure)
    args.progress("report", None)
    sections = list(_sections(results, rows, timings, series, args.measure))
    table = [_shown(row, timing) for row, timing in zip(rows[:_MOST_ROWS], timings, strict=False)]
    write_text(target, page(f"Study {results.folder.name()}", list(_about(rows, timings)), table, sections))
    args.progress.close()
    if not args.quiet:
        for each in series:
            order = "" if each.order is None else f", order {each.order:.2f}"
            print(f"{each.name}: {len(each.errors)} fits, least error {min(each.errors):.2e}{order}")
        print(target)
    return 0


def _about(rows: list[Any], timings: list[Any]) -> Iterator[tuple[str, str]]:
    """What the study is and where it was done, in words."""
    states = [row["status"] for row in rows]
    yield "fits", ", ".join(f"{states.count(state)} {state}" for state in ("done", "failed", "lost") if state in states)
    yield "time", f"{sum(each.get('total', 0.0) for each in timings):.1f} s in all"
    peak = max((each.get("peak", 0) for each in timings), default=0)
    yield "memory", f"at most {peak / 1e6:.0f} MB in one process"
    for title, name in (("machine", "host"), ("system", "system"), ("processor", "processor"), ("sources", "git")):
        yield title, ", ".join(sorted({str(each[name]) for each in timings if each.get(name)}))
    versions = {", ".join(map(" ".join, each["versions"].items())) for each in timings if "versions" in each}
    yield "versions", "; ".join(sorted(versions))
    if len(rows) > _MOST_ROWS:
        yield "table", f"the first {_MOST_ROWS} of {len(rows)} fits; all are in table.jsonl"


def _sections(
    results: Results, rows: list[Any], timings: list[Any], series: list[Any], measure: str
) -> Iterator[tuple[str, str]]:
    from orbiframe_studies.page import picture, plot
    from orbiframe_studies.plots import error_plot, surface_picture, time_plot

    short = told_apart([each.name for each in series])
    named = [replace(each, name=name) for each, name in zip(series, short, strict=True)]
    yield "Error against unknowns", plot(error_plot(named, measure))
    slow = sorted(range(len(rows)), key=lambda i: -timings[i].get("total", 0.0))[:_MOST_BARS]
    titles = told_apart([title(row) for row in rows])
    names = [f"{rows[i]['run']}: {titles[i]}" for i in sorted(slow)]
    yield "Times", plot(time_plot(names, [timings[i].get("seconds", {}) for i in sorted(slow)]))
    has_arrays = [results.folder.kept(row["key"], ".h5").exists() for row in rows]
    kept = [(row, name) for row, name, has in zip(rows, titles, has_arrays, strict=True) if has]
    if kept:
        chosen = kept[:: -(-len(kept) // _MOST_PICTURES)]
        figures = (picture(surface_picture(results.arrays(row["key"])), name) for row, name in chosen)
        yield "Surfaces", "\n".join(figures)


def told_apart(names: Sequence[str]) -> list[str]:
    """The names without the parts at their beginning that all of them share; each keeps one part at least."""
    parts = [name.split(", ") for name in names]
    shared, most = 0, min(map(len, parts), default=1) - 1
    while shared < most and len({each[shared] for each in parts}) == 1:
        shared += 1
    return [", ".join(each[shared:]) for each in parts] if len(names) > 1 else list(names)


def title(row: Any) -> str:
    """What a fit is, in a few words."""
    values = [str(value) if isinstance(value, str) else f"{name} {value}" for name, value in row["parameters"].items()]
    seed = [] if row["seed"] is None else [f"seed {row['seed']}"]
    return ", ".join(filter(None, [Path(row["mesh"]).stem, row["case"], *values, *seed]))


def _shown(row: Any, timing: Any) -> dict[str, Any]:
    """The cells of a row."""
    report = row["report"] or {}
    fit = report.get("fit", {})
    found = {"run": row["run"], "mesh": row["mesh"], "case": row["case"], "seed": row["seed"], **row["parameters"]}
    found = {name: value for name, value in found.items() if value not in (None, "")}
    return {
        **found,
        "status": row["status"],
        "unknowns": fit.get("size"),
        "rms": fit.get("rms"),
        "max": fit.get("max"),
        "seconds": timing.get("total"),
        "MB": round(timing.get("peak", 0) / 1e6, 1),
        "error": "" if row["error"] is None else row["error"]["text"],
    }
