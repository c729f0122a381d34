"""Datasets: meshes that come with orbiframe, called "dataset:torus" wherever a file is asked for."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from orbiframe.components.shown_text import shown
from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import FormatError

PREFIX = "dataset:"
_SUFFIX = ".off"


def located(path: str | Path) -> Path:
    """The file of a dataset for "dataset:NAME"; any other path as it is.

    Raises FormatError for a name that is not there; the sentence names the nearest one and all.
    """
    text = str(path)
    if not text.startswith(PREFIX):
        return Path(path)
    folder, name = _folder(), text.removeprefix(PREFIX).removesuffix(_SUFFIX)
    known = sorted(file.stem for file in folder.glob(f"*{_SUFFIX}"))
    if name not in known:
        listed = ", ".join(known) or "none in this installation"
        raise FormatError(f"there is no dataset '{shown(name, 100)}'; there are {listed}.{did_you_mean(name, known)}")
    return folder / f"{name}{_SUFFIX}"


def called(path: Path) -> str:
    """The other way: "dataset:NAME" for the file of a dataset, and any other path as it is written."""
    known = path.suffix == _SUFFIX and path.parent == _folder()
    return f"{PREFIX}{path.stem}" if known else path.as_posix()


def _folder() -> Path:
    """Within an installed package, or beside it in a checkout."""
    package = Path(str(files("orbiframe")))
    inside = package / "datasets"
    return inside if inside.is_dir() else package.parent / "datasets"
