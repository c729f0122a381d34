"""Tables in Markdown of the results."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from quality.results import Result

By = dict[str, dict[str, Result]]
MEASURES: dict[str, tuple[str, Callable[[Result], float | None], Callable[[float], str]]] = {
    "position": ("Position: root mean square of the distance, in diagonals", lambda r: r.rms, lambda x: f"{x:.1e}"),
    "max": ("Position: largest distance, in diagonals", lambda r: r.max, lambda x: f"{x:.1e}"),
    "normals": ("Normals: root mean square of the angle, in degrees", lambda r: r.normals, lambda x: f"{x:.2g}"),
    "curvature": (
        "Gaussian curvature: error in per cent of its root mean square",
        lambda r: None if r.curvature is None else 100 * r.curvature,
        lambda x: f"{x:.2g}" if x < 100 else f"{x:.0f}" if x < 1000 else "> 1000",
    ),
    "crossing": ("Triangles of the output that meet others", lambda r: r.crossing, lambda x: f"{x:.0f}"),
    "seconds": ("Processor seconds", lambda r: r.seconds, lambda x: f"{x:.1f}"),
}


def tables(by: By, methods: Sequence[str]) -> Iterator[str]:
    """The summary, and a table for every measure."""
    yield "### Summary\n"
    yield from summary(by, methods)
    for title, value, text in MEASURES.values():
        yield f"\n### {title}\n"
        yield from table(by, methods, value, text)


def table(
    by: By, methods: Sequence[str], value: Callable[[Result], float | None], text: Callable[[float], str]
) -> Iterator[str]:
    """A row for every shape that has values; the smallest is bold; a dash where there is no surface."""
    yield _line(["shape", "vertices", *methods])
    yield _line(["---"] * (len(methods) + 2))
    for shape, row in by.items():
        values = [value(row[m]) if m in row else None for m in methods]
        if any(v is not None for v in values):
            best = min(v for v in values if v is not None)
            cells = ["–" if v is None else f"**{text(v)}**" if v == best and best > 0 else text(v) for v in values]
            yield _line([shape, str(next(iter(row.values())).vertices), *cells])


def summary(by: By, methods: Sequence[str]) -> Iterator[str]:
    """Of every kind of shape, the geometric mean of the errors of position (of how many, where one is missing)."""
    yield _line(["kind", "shapes", *methods])
    yield _line(["---"] * (len(methods) + 2))
    for kind in dict.fromkeys(next(iter(row.values())).kind for row in by.values()):
        rows = [row for row in by.values() if next(iter(row.values())).kind == kind]
        yield _line([kind, str(len(rows)), *(_mean(rows, m) for m in methods)])
    yield _line(["surfaces made", str(len(by)), *(str(_made(by, m)) for m in methods)])
    yield _line(["nearest of all", str(len(by)), *(str(_best(by, m)) for m in methods)])


def _mean(rows: list[dict[str, Result]], method: str) -> str:
    found = [row[method].rms for row in rows if method in row and row[method].rms]
    return (
        f"{np.exp(np.mean(np.log(found))):.1e}" + ("" if len(found) == len(rows) else f" ({len(found)})")
        if found
        else "–"
    )


def _made(by: By, method: str) -> int:
    return sum(method in row and row[method].rms is not None for row in by.values())


def _best(by: By, method: str) -> int:
    count = 0
    for row in by.values():
        made = {m: r.rms for m, r in row.items() if r.rms is not None}
        count += method in made and made[method] == min(made.values())
    return count


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cells) + " |"
