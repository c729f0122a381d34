"""Draw the orders of the study of the paper's example: `python docs/pictures/two_holed_box.py FOLDER [FILE.png]`.

FOLDER is that of `orbiframe run docs/examples/two_holed_box.toml --into FOLDER`.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

from orbiframe_studies.orders import series_of
from orbiframe_studies.plots import error_figure
from orbiframe_studies.results import Results


def draw(folder: Path, target: Path) -> None:
    """The errors of every family of functions against their number, with the fitted orders."""
    series = [replace(each, name=each.name.split(", ")[1]) for each in series_of(Results.of(folder).rows())]
    figure = error_figure(series, "fit.rms")
    figure.savefig(target, dpi=75, bbox_inches="tight", metadata={"Software": None})


if __name__ == "__main__":
    target = sys.argv[2] if len(sys.argv) > 2 else Path(__file__).with_name("two_holed_box_orders.png")
    draw(Path(sys.argv[1]), Path(target))
