"""Trials of mutants: a copy of the tree in which faults are planted, and processes that run chosen tests in it.

A process is forked from this one, which has loaded the libraries, and ends at the first test that fails.
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[1]
SOURCES = ("orbiframe", "plugins")
_MEMORY = 14 * 2**30
# Seconds by the clock for a processor second that a process is allowed: other work goes on beside.
_PATIENCE = 20
# Of pytest: all passed, or none was chosen.
_GOOD = (0, 5)
_LIBRARIES = (
    "hypothesis", "meshio", "mpmath", "numba", "numpy", "pluggy", "pydantic", "pymetis", "pytest", "scipy.linalg",
    "scipy.optimize", "scipy.sparse.csgraph", "scipy.sparse.linalg", "scipy.spatial", "scipy.special", "OCP.TopoDS",
)  # fmt: skip


class Outcome(NamedTuple):
    """How a run of tests ended: the first test that failed ("" if none did), whether in time, and its seconds."""

    failed: str
    in_time: bool
    seconds: float


def load_libraries() -> None:
    """Import what the tests need and what is not under trial, once for all processes."""
    for name in _LIBRARIES:
        with suppress(ImportError):
            __import__(name)


class Tree:
    """A copy of the tracked and the new files of the tree, in which one source at a time may be changed."""

    def __init__(self, folder: Path) -> None:
        self.root, self.code = folder / "tree", folder / "code"
        self._changes = 0
        self._update()

    def _update(self) -> None:
        """Bring the copy up to date; files that are alike are left as they are, and with them what is cached."""
        command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
        wanted = {name for name in names if (ROOT / name).is_file()}
        for old in [p for p in self.root.rglob("*") if p.is_file() and "__pycache__" not in p.parts]:
            if str(old.relative_to(self.root)) not in wanted:
                old.unlink()
        for name in sorted(wanted):
            source, target = ROOT / name, self.root / name
            if not target.exists() or target.read_bytes() != source.read_bytes():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, target)

    @contextmanager
    def changed(self, path: str, source: bytes, is_compiled: bool) -> Iterator[Path]:
        """The folder of machine code while a source is another; where it is compiled, a folder for this mutant alone.

        A time of its own tells Python that the file is another one, even within the same second and at the same size.
        """
        file = self.root / path
        before, times = file.read_bytes(), file.stat()
        self._changes += 1
        try:
            file.write_bytes(source)
            os.utime(file, (times.st_atime, times.st_mtime + 10 * self._changes))
            yield self._linked_code() if is_compiled else self.code
        finally:
            file.write_bytes(before)
            os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))

    def _linked_code(self) -> Path:
        """All machine code as links: files that no longer fit are replaced there, and stay as they are here."""
        linked = self.code.with_name("code_of_mutant")
        shutil.rmtree(linked, ignore_errors=True)
        if self.code.exists():
            shutil.copytree(self.code, linked, copy_function=os.link)
        return linked

    def run(self, plugin: Any, files: Sequence[str], limit: float, code: Path | None = None) -> Outcome:
        """Run test files in a new process with a plugin of pytest; the plugin may send lines to `plugin.received`.

        limit: processor seconds; a process that only waits is ended after some times as many by the clock.
        """
        read, write = os.pipe()
        start = time.perf_counter()
        child = os.fork()
        if not child:
            os.close(read)
            resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 1, int(limit) + 10))
            _in_child(self.root, code or self.code, plugin, files, write)
        os.close(write)
        reader = threading.Thread(target=_receive, args=(read, plugin.received))
        reader.start()
        status = _wait(child, start + _PATIENCE * limit)
        reader.join(5)
        late = status in (None, -signal.SIGXCPU)
        failed = plugin.failed or ("" if late or status in _GOOD else f"the process ended with {status}")
        return Outcome(failed, not late, time.perf_counter() - start)


def _receive(end: int, received: Callable[[Any], None]) -> None:
    with os.fdopen(end) as lines, suppress(json.JSONDecodeError):
        for line in lines:
            received(json.loads(line))


def _wait(child: int, deadline: float) -> int | None:
    """The exit status of a process, None if it did not end before the deadline; all that it started ends with it."""
    done = status = 0
    while not done and time.perf_counter() < deadline:
        done, status = os.waitpid(child, os.WNOHANG)
        time.sleep(0.005)
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    if not done:
        os.waitpid(child, 0)
    return os.waitstatus_to_exitcode(status) if done else None


def _in_child(root: Path, code: Path, plugin: Any, files: Sequence[str], write: int) -> None:
    """Run the tests and end the process."""
    status = 1
    try:
        os.setpgid(0, 0)
        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
        log = os.open(root.parent / "log.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        os.dup2(log, 1)
        os.dup2(log, 2)
        os.chdir(root)
        _look_only_in(root, code)
        plugin.send = os.fdopen(write, "w", buffering=1)
        status = _tests(plugin, files)
    finally:
        os._exit(status)


def _look_only_in(root: Path, code: Path) -> None:
    """Import the copy, here and in processes that tests start, and keep compiled code in a folder."""
    import numba

    paths = [str(root), str(root / "plugins")]
    sys.path[:] = paths + [path for path in sys.path if not Path(path).resolve().is_relative_to(ROOT / "benchmarks")]
    os.environ["PYTHONPATH"] = os.pathsep.join(paths)
    os.environ["NUMBA_CACHE_DIR"] = numba.config.CACHE_DIR = str(code)
    assert not any(name.startswith("orbiframe") for name in sys.modules)


def _tests(plugin: Any, files: Sequence[str]) -> int:
    import hypothesis
    import pytest

    hypothesis.settings.register_profile(
        "mutants",
        derandomize=True,
        database=None,
        deadline=None,
        phases=(hypothesis.Phase.explicit, hypothesis.Phase.generate),
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    hypothesis.settings.load_profile("mutants")
    options = ["-q", "--no-header", "--tb=no", "-p", "no:cacheprovider", "-n0"]
    # These libraries are loaded before pytest begins.
    options += ["-W", "ignore::pytest.PytestAssertRewriteWarning"]
    return int(pytest.main([*options, *plugin.options, *files], plugins=[plugin]))
