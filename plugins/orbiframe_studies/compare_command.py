"""orbiframe compare: two studies run by run."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe import Registry

if TYPE_CHECKING:
    from orbiframe_studies.results import Results

Row = dict[str, Any]
# Errors that differ by less are equal: what rounding makes of them on another processor.
_EQUAL = 1e-9


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("first", metavar="A", type=Path, help="the folder of a study, or its file")
    add("second", metavar="B", type=Path, help="the study to compare with it")
    add("--measure", metavar="NAME", default="fit.rms", help="the error: fit.rms, which is the default, or fit.max")
    add("--json", action="store_true", help="print one JSON object instead of the table")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, _: Registry) -> int:
    """Say which fits differ and how; fits belong together that have one mesh, case, seed and the same parameters."""
    from orbiframe_studies.results import Results
    from orbiframe_studies.study import require_measure

    require_measure(args.measure)
    found = compared(Results.of(args.first), Results.of(args.second), args.measure)
    print(json.dumps(found) if args.json else "\n".join(_lines(found, args.measure)))
    return 0


def compared(first: Results, second: Results, measure: str) -> dict[str, Any]:
    """What two studies have in common: pairs of fits that differ, how many are equal, and those of one study alone.

    error and seconds: those of B by those of A, the geometric mean of all pairs of fits that are done.
    """
    a, b = _by_name(first), _by_name(second)
    both = [name for name in a if name in b]
    pairs = [_pair(name, a[name], b[name], measure) for name in both]
    done = [pair for pair in pairs if pair["first"]["status"] == pair["second"]["status"] == "done"]
    return {
        "fits": len(both),
        "equal": sum(pair["equal"] for pair in pairs),
        "error": _mean_ratio([(pair["first"]["error"], pair["second"]["error"]) for pair in done]),
        "seconds": _mean_ratio([(pair["first"]["seconds"], pair["second"]["seconds"]) for pair in done]),
        "different": [pair for pair in pairs if not pair["equal"]],
        "only_first": [name for name in a if name not in b],
        "only_second": [name for name in b if name not in a],
    }


def _by_name(results: Results) -> dict[str, tuple[Row, Row]]:
    """The rows with their timings by what names a fit."""
    pairs = zip(results.rows(), results.timings(), strict=True)
    return {_name(row): (row, timing) for row, timing in pairs}


def _name(row: Row) -> str:
    parameters = [f"{name} = {json.dumps(value)}" for name, value in sorted(row["parameters"].items())]
    seed = [] if row["seed"] is None else [f"seed {row['seed']}"]
    return ", ".join(filter(None, [row["mesh"], row["case"], *parameters, *seed]))


def _pair(name: str, first: tuple[Row, Row], second: tuple[Row, Row], measure: str) -> dict[str, Any]:
    from orbiframe_studies.plan import measured

    sides = [
        {"status": row["status"], "error": measured(row, measure), "seconds": timing.get("total")}
        for row, timing in (first, second)
    ]
    return {"fit": name, "equal": _equal(*sides), "first": sides[0], "second": sides[1]}


def _equal(first: Row, second: Row) -> bool:
    if first["error"] is None or second["error"] is None:
        return bool(first["status"] == second["status"])
    return math.isclose(first["error"], second["error"], rel_tol=_EQUAL)


def _mean_ratio(pairs: list[tuple[float | None, float | None]]) -> float | None:
    ratios = [math.log(b / a) for a, b in pairs if a and b]
    return math.exp(sum(ratios) / len(ratios)) if ratios else None


def _lines(found: dict[str, Any], measure: str) -> Iterator[str]:
    yield f"fits      {found['fits']} in both, {found['equal']} with equal {measure}"
    for title, key in (("error", "error"), ("seconds", "seconds")):
        if found[key] is not None:
            yield f"{title:<10}{found[key]:.3g} times those of A, in the geometric mean"
    for pair in found["different"]:
        yield f"          {pair['fit']}: {_side(pair['first'])} → {_side(pair['second'])}"
    for title, key in (("only in A", "only_first"), ("only in B", "only_second")):
        for name in found[key]:
            yield f"{title:<10}{name}"


def _side(side: Row) -> str:
    return side["status"] if side["error"] is None else f"{side['error']:.3e}"
