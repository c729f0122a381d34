"""Machine: where a fit was done, with what, and the state of the sources that asked for it."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
from functools import lru_cache
from pathlib import Path

from orbiframe.fitting import versions

_PATIENCE = 10


@lru_cache(maxsize=1)
def machine() -> dict[str, str | int | dict[str, str]]:
    """The machine of this process, and the versions that results depend on."""
    return {
        "host": platform.node(),
        "system": platform.platform(),
        "processor": _processor(),
        "cores": os.cpu_count() or 1,
        "versions": versions(),
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def git_state(folder: Path) -> str:
    """The commit of a folder under git, with "+" where files differ from it; empty elsewhere."""
    if shutil.which("git") is None:
        return ""
    commit = _git(folder, "rev-parse", "HEAD")
    return f"{commit}{'+' if _git(folder, 'status', '--porcelain', '--untracked-files=no') else ''}" if commit else ""


def _git(folder: Path, *arguments: str) -> str:
    command = ["git", "-C", str(folder.absolute()), *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=_PATIENCE)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
