"""Memory of processes: what they have, and the most that this one has had."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

_PAGE = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096
_STATUS, _RESET = Path("/proc/self/status"), Path("/proc/self/clear_refs")


def resident_memory(process: int) -> int:
    """The bytes of a process that are resident now; 0 where nobody knows, as outside Linux."""
    with suppress(OSError, ValueError, IndexError):
        return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * _PAGE
    return 0


def reset_peak() -> None:
    """Begin anew to watch the peak, where the system allows it; elsewhere it is that since the process began."""
    with suppress(OSError):
        _RESET.write_text("5")


def peak_memory() -> int:
    """The most bytes that have been resident since `reset_peak`; 0 where nobody knows."""
    with suppress(OSError, ValueError):
        for line in _STATUS.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
    with suppress(ImportError):
        import resource

        used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return used if sys.platform == "darwin" else used * 1024
    return 0
