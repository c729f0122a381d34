"""Study folder: the one place of a study; who works in it, whose it is, and the files in it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from orbiframe import FormatError, UsageError
from orbiframe.components import shown
from orbiframe.files import file_lock, write_text

_KIND = "orbiframe study 1"


@dataclass(frozen=True, slots=True)
class StudyFolder:
    """The files of a study: who it is, its journal, its table, its maps and what is kept of each fit."""

    path: Path

    @property
    def identity(self) -> Path:
        """What says that the folder is one of a study, and of which."""
        return self.path / "study.json"

    @property
    def journal(self) -> Path:
        """A line for every fit that has ended, in the order in which they did."""
        return self.path / "journal.jsonl"

    @property
    def table(self) -> Path:
        """A line for every fit, in the order of the study, without times."""
        return self.path / "table.jsonl"

    @property
    def timings(self) -> Path:
        """A line for every fit, in the order of the study: times, memory, versions, machine."""
        return self.path / "timings.jsonl"

    @property
    def maps(self) -> Path:
        """The maps to X/H."""
        return self.path / "maps"

    def kept(self, key: str, suffix: str) -> Path:
        """The file with what is kept of a fit."""
        return self.path / "kept" / key[:2] / f"{key}{suffix}"

    def name(self) -> str:
        """The name of the study that the folder belongs to. Raises UsageError where it is no study's folder."""
        try:
            found = json.loads(self.identity.read_text(encoding="utf-8"))
            if found["kind"] == _KIND and isinstance(found["name"], str):
                return str(found["name"])
        except (OSError, ValueError, KeyError, TypeError):
            pass
        raise UsageError(f"{self.path}: this is no folder of a study; make one with `orbiframe run STUDY.toml`")


def existing(path: Path) -> StudyFolder:
    """The folder of a study that has been run: its path, or that of its study file."""
    folder = StudyFolder(path.with_suffix("") if path.is_file() and path.suffix == ".toml" else path)
    folder.name()
    return folder


@contextmanager
def opened(path: Path, name: str, source: Path) -> Iterator[StudyFolder]:
    """The folder of a study, made if it is not there, for one process at a time.

    Raises UsageError for the folder of another study or of something else, FormatError for one that cannot be made or
    in which another process works.
    """
    folder = StudyFolder(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
        stranger = not folder.identity.exists() and any(entry.name != "lock" for entry in path.iterdir())
        with file_lock(path / "lock", wait=False) as mine:
            if not mine:
                raise FormatError(
                    f"{path}: another `orbiframe run` works in this folder; wait for it, or give another with --into"
                )
            if stranger:
                raise UsageError(f"{path}: the folder holds other things; give another with --into")
            if not folder.identity.exists():
                write_text(folder.identity, json.dumps({"kind": _KIND, "name": name, "file": str(source)}) + "\n")
            owner = folder.name()
            if owner != name:
                raise UsageError(
                    f"{path}: this is the folder of the study '{shown(owner, 100)}', not of '{shown(name, 100)}'; give "
                    "another with --into"
                )
            yield folder
    except OSError as error:
        if error.filename is None:
            raise
        raise FormatError(
            f"{path} cannot be used: {error.strerror or error}; give another folder with --into"
        ) from error
