"""Page: a study as one HTML file that needs nothing else, with a table that can be sorted and filtered."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterator, Sequence
from typing import Any

Row = dict[str, Any]

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 76rem; padding: 0 1rem; color: #222 }
h1 { font-size: 1.6rem } h2 { font-size: 1.15rem; margin-top: 2.2rem }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums }
th, td { padding: .25rem .6rem; border-bottom: 1px solid #ddd; text-align: left; white-space: nowrap }
th { cursor: pointer; position: sticky; top: 0; background: #f4f6f8 }
th[data-way="1"]::after { content: " ▲" } th[data-way="-1"]::after { content: " ▼" }
td.number { text-align: right } tr.failed td { background: #fff1f0 } .error { white-space: normal; max-width: 28rem }
.about td + td { white-space: normal; overflow-wrap: anywhere }
.scroll { overflow: auto; max-height: 34rem; border: 1px solid #ddd } .plot { overflow-x: auto }
svg { max-width: 100%; min-width: 40rem; height: auto } img { max-width: 100% }
input { font: inherit; padding: .25rem .5rem; width: 22rem; max-width: 95%; margin-bottom: .6rem }
figure { display: inline-block; margin: .4rem; text-align: center } figcaption { font-size: 12px; max-width: 20rem }
"""
_SCRIPT = """
const table = document.querySelector("#fits"), body = table.tBodies[0];
const value = (row, i) => row.cells[i].dataset.value ?? row.cells[i].textContent;
table.tHead.querySelectorAll("th").forEach((head, i) => head.addEventListener("click", () => {
  const way = head.dataset.way === "1" ? -1 : 1;
  table.tHead.querySelectorAll("th").forEach(other => delete other.dataset.way);
  head.dataset.way = way;
  const rows = [...body.rows].sort((a, b) => {
    const [x, y] = [value(a, i), value(b, i)], [p, q] = [parseFloat(x), parseFloat(y)];
    return way * (isNaN(p) || isNaN(q) ? x.localeCompare(y) : p - q);
  });
  body.append(...rows);
}));
document.querySelector("#filter").addEventListener("input", event => {
  const words = event.target.value.toLowerCase().split(/\\s+/).filter(Boolean);
  for (const row of body.rows) {
    const text = row.textContent.toLowerCase();
    row.hidden = !words.every(word => text.includes(word));
  }
});
"""


def page(title: str, about: Sequence[tuple[str, str]], rows: Sequence[Row], sections: Sequence[tuple[str, str]]) -> str:
    """The page: what the study is, further sections of HTML, each with its title, and the table of all fits."""
    parts = [
        "<!doctype html>",
        '<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">',
        f"<title>{_safe(title)}</title><style>{_STYLE}</style></head><body>",
        f"<h1>{_safe(title)}</h1><table class='about'>",
        *(f"<tr><td>{_safe(name)}</td><td>{_safe(text)}</td></tr>" for name, text in about if text),
        "</table>",
        *(f"<h2>{_safe(name)}</h2>{content}" for name, content in sections),
        '<h2>Fits</h2><input id="filter" placeholder="words that a row must contain" aria-label="filter">',
        *_table(rows),
        f"<script>{_SCRIPT}</script></body></html>",
    ]
    return "\n".join(parts) + "\n"


def plot(svg: str) -> str:
    """A plot, as HTML; where the page is narrow it can be moved."""
    return f'<div class="plot">{svg}</div>'


def picture(png: bytes, caption: str) -> str:
    """A picture with its caption, as HTML."""
    data = base64.b64encode(png).decode()
    return (
        f'<figure><img alt="{_safe(caption)}" src="data:image/png;base64,{data}">'
        f"<figcaption>{_safe(caption)}</figcaption></figure>"
    )


def _table(rows: Sequence[Row]) -> Iterator[str]:
    names = list(dict.fromkeys(name for row in rows for name in row))
    heads = "".join(f"<th>{_safe(name)}</th>" for name in names)
    yield f'<div class="scroll"><table id="fits"><thead><tr>{heads}</tr></thead><tbody>'
    for row in rows:
        mark = "" if row.get("status") == "done" else ' class="failed"'
        yield f"<tr{mark}>{''.join(_cell(name, row.get(name)) for name in names)}</tr>"
    yield "</tbody></table></div>"


def _cell(name: str, value: Any) -> str:
    if isinstance(value, bool) or not isinstance(value, int | float):
        kind = ' class="error"' if name == "error" else ""
        return f"<td{kind}>{_safe('' if value is None else str(value))}</td>"
    shown = str(value) if isinstance(value, int) else f"{value:.4g}"
    return f'<td class="number" data-value="{value!r}">{shown}</td>'


def _safe(text: str) -> str:
    return html.escape(text)
