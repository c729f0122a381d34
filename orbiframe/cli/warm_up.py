"""orbiframe warm-up: compiles what the other commands need, so that none of them has to wait for it."""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import shlex
import sys
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from orbiframe.cli.speech import say
from orbiframe.cli.status_line import status_line
from orbiframe.compiled import compilation
from orbiframe.components.registry import Registry
from orbiframe.errors import OrbiframeError

if TYPE_CHECKING:
    from orbiframe.meshes.polyhedron import Polyhedron

_BAR = 20
# Of a torus of 2 n^2 triangles: large enough for all that is done only to large meshes.
_LARGE = 419


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    parser.set_defaults(run=run)


class _Count:
    """How many functions are compiled."""

    def __init__(self) -> None:
        self.compiled = 0

    def begins(self, name: str) -> None:  # noqa: ARG002
        self.compiled += 1

    def ends(self) -> None: ...


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Run the commands that the plugins name, in a folder with small meshes; the status is 1 if one fails."""
    commands, failed, count = registry.warm_up_commands(), 0, _Count()
    with compilation.heard(count), _sample_folder(registry):
        for number, command in enumerate(commands):
            if not args.quiet:
                _say(number, len(commands), command)
            failed += not _succeeds(command, registry)
    if not args.quiet:
        _say(len(commands), len(commands), "done")
        print(f"compiled {count.compiled} functions" if count.compiled else "nothing to compile: all is kept")
    return 1 if failed else 0


def _say(number: int, total: int, text: str) -> None:
    if line := status_line(sys.stderr):
        filled = _BAR * number // total
        bar = f"[{'=' * filled}{' ' * (_BAR - filled)}] {number} of {total}: {text}"
        line.leave(bar) if number == total else line.show(bar)
    elif number < total:
        say(f"{number + 1} of {total}: {text}")


def _succeeds(command: str, registry: Registry) -> bool:
    from orbiframe.cli.main import parsed

    # What the commands say of the small meshes helps nobody.
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        args = parsed(shlex.split(command), registry)
        try:
            return int(args.run(args, registry)) == 0
        except OrbiframeError as error:
            say(f"{command}: {error}")
            return False


@contextlib.contextmanager
def _sample_folder(registry: Registry) -> Iterator[None]:
    """Work in a folder with the meshes that `orbiframe_warm_up` promises."""
    from orbiframe.files import gate
    from orbiframe.testing.polyhedra import reference_polyhedra

    samples = {**reference_polyhedra(), "large": _large_torus(_LARGE)}
    with tempfile.TemporaryDirectory() as folder:
        for name, polyhedron in samples.items():
            gate.write(Path(folder) / f"{name.replace(' ', '_').lower()}.off", polyhedron, registry)
        before = Path.cwd()
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def _large_torus(n: int) -> Polyhedron:
    import numpy as np

    from orbiframe.meshes.polyhedron import Polyhedron

    here = np.arange(n * n).reshape(n, n)
    right, up, across = np.roll(here, -1, 1), np.roll(here, -1, 0), np.roll(here, (-1, -1), (0, 1))
    faces = np.stack([here, up, across, here, across, right], axis=-1).reshape(-1, 3)
    u, v = np.meshgrid(*[2 * np.pi * np.arange(n) / n] * 2, indexing="ij")
    vertices = np.stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)], axis=-1)
    return Polyhedron.from_faces(vertices.reshape(-1, 3), faces)
