"""Memory of this process: how much it may take, and how much it has taken."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path

_STATUS, _RESET = Path("/proc/self/status"), Path("/proc/self/clear_refs")


def limit_memory(size: int) -> None:
    """Let whatever needs more than so many bytes of data end in a MemoryError, where the system can see to that."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (size, resource.getrlimit(resource.RLIMIT_DATA)[1]))


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
