"""Results: the tables of a study that has been run, for Python."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from orbiframe import FormatError, PluginError
from orbiframe_studies.arrays import SurfaceArrays, read_arrays
from orbiframe_studies.study_folder import StudyFolder, existing

Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Results:
    """The results of a study by its folder; rows are read when they are asked for.

    Raises UsageError where the folder is none of a study.
    """

    folder: StudyFolder

    @classmethod
    def of(cls, path: str | Path) -> Results:
        """The results in a folder, or in that of a study file."""
        return cls(existing(Path(path)))

    def rows(self) -> Iterator[Row]:
        """Every fit, in the order of the study: what names it, its parameters, its report. Raises FormatError."""
        yield from _lines(self.folder.table)

    def timings(self) -> Iterator[Row]:
        """The times, memory, versions and machine of every fit, in the same order. Raises FormatError."""
        yield from _lines(self.folder.timings)

    def flat_rows(self) -> Iterator[Row]:
        """Every fit with its timing as one level of names, such as "basis.size", "fit.rms" or "timing.total"."""
        for row, timing in zip(self.rows(), self.timings(), strict=True):
            flat = {name: value for name, value in row.items() if name not in ("parameters", "report", "error")}
            flat |= row["parameters"]
            flat |= {f"error.{name}": value for name, value in (row["error"] or {}).items()}
            flat |= _flattened(row["report"] or {}, "")
            own = {name: value for name, value in timing.items() if name not in ("run", "key")}
            yield flat | _flattened(own, "timing.")

    def to_pandas(self) -> Any:
        """A pandas DataFrame with a row for each fit; see `flat_rows`. Raises PluginError without pandas."""
        try:
            import pandas as pd
        except ImportError as error:
            raise PluginError('to_pandas needs pandas: pip install "orbiframe[studies]"') from error
        return pd.DataFrame(list(self.flat_rows()))

    def to_polars(self) -> Any:
        """A polars DataFrame with a row for each fit; see `flat_rows`. Raises PluginError without polars."""
        try:
            import polars as pl
        except ImportError as error:
            raise PluginError('to_polars needs polars: pip install "orbiframe[studies]"') from error
        return pl.DataFrame(list(self.flat_rows()), infer_schema_length=None, strict=False)

    def arrays(self, key: str) -> list[SurfaceArrays]:
        """The arrays of a fit, one entry for each component; for studies with keep = ["arrays"]."""
        return read_arrays(self.folder.kept(key, ".h5"))


def _lines(path: Path) -> Iterator[Row]:
    try:
        with path.open(encoding="utf-8") as file:
            for number, line in enumerate(file, start=1):
                if line.strip():
                    yield _line(path, number, line)
    except (OSError, UnicodeDecodeError) as error:
        raise FormatError(f"{path} cannot be read: {error}; run the study again, which writes it anew") from error


def _line(path: Path, number: int, line: str) -> Row:
    try:
        found: Row = json.loads(line)
        found["run"], found["key"]
    except (ValueError, KeyError, TypeError) as error:
        raise FormatError(
            f"{path}, line {number}: this is no row of a study; run the study again, which writes the table anew"
        ) from error
    return found


def _flattened(table: Row, before: str) -> Row:
    found: Row = {}
    for name, value in table.items():
        if isinstance(value, dict):
            found |= _flattened(value, f"{before}{name}.")
        else:
            found[f"{before}{name}"] = "; ".join(map(str, value)) if isinstance(value, list) else value
    return found
