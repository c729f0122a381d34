"""The files that a fit enters, in the order of their first call: `python benchmarks/files_entered.py MESH [OPTIONS]`.

The way of one mesh through the house, seen by a profiler: every file of orbiframe and its plugins of which a function
runs, with all code loaded and compiled before. MESH and options are those of `orbiframe fit`; nothing is kept.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import orbiframe
from orbiframe.cli.main import main

HOMES = [Path(orbiframe.__file__).parent.parent, Path(orbiframe.__file__).parent.parent / "plugins"]


def entered(run: Callable[[], object]) -> list[str]:
    """The files of the house in which functions run, in the order of their first call."""
    found: dict[str, None] = {}

    def listen(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and frame.f_code.co_name != "<module>":
            found.setdefault(frame.f_code.co_filename)

    sys.setprofile(listen)
    try:
        run()
    finally:
        sys.setprofile(None)
    return [name for file in found if (name := _place(Path(file))) is not None]


def _place(file: Path) -> str | None:
    """The path of a file in the house, from the kernel's or the plugin's folder on; None for foreign files."""
    for home in reversed(HOMES):
        if home in file.parents and file.relative_to(home).parts[0].startswith("orbiframe"):
            return file.relative_to(home).as_posix()
    return None


def of_fit(arguments: list[str]) -> list[str]:
    """The files that `orbiframe fit` enters, the second time it runs."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["fit", *arguments, "-o", str(Path(folder) / "surface.ply"), "--quiet"]
        if main(command):
            sys.exit(1)
        return entered(lambda: main(command))


if __name__ == "__main__":
    files = of_fit(sys.argv[1:])
    kernel = [name for name in files if name.startswith("orbiframe/")]
    print("\n".join(files))
    print(f"{len(files)} files, {len(kernel)} of the kernel")
