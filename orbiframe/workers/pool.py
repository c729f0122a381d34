"""Pool: the same task for many items, in some processes of this machine or in this one.

Items are taken when a process is free for them, and outcomes given when they are there: nothing grows with their
number. A process that dies costs nobody else anything: its item is tried once more, in a new one.
"""

from __future__ import annotations

import pickle
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

from orbiframe.workers.memory import resident_memory
from orbiframe.workers.worker_process import Task

_START = "from orbiframe.workers.worker_process import main; main()"
_ATTEMPTS = 2
_PATIENCE, _GLANCE = 0.2, 0.05
_TOO_MUCH = "for taking more memory than"

Listener = Callable[[Any, str, float | None], None]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of an item: a result, or the error that the task raised, or how its process ended (`lost`)."""

    item: Any
    result: Any = None
    error: BaseException | None = None
    lost: str = ""


def work(
    items: Iterable[Any],
    make: Callable[..., Task],
    arguments: tuple[Any, ...] = (),
    *,
    workers: int = 1,
    memory: int | None = None,
    told: Listener = lambda *_: None,
) -> Iterator[Outcome]:
    """The outcome of a task for every item, in the order in which they come.

    make(*arguments), called in each process, is the task: called as task(item, tell), where tell(stage, seconds) may be
    called at any time and reaches `told(item, stage, seconds)` here. With one worker all happens in this process, one
    item after the other; else in others, and functions, arguments, items and results are pickled. memory: bytes that a
    process may take, in one apart even for one worker; one that takes more ends, and its item is lost. Whatever ends
    the iteration ends the processes.
    """
    if workers == 1 and memory is None:
        yield from _here(items, make(*arguments), told)
    else:
        yield from _Pool(iter(items), (make, arguments), told, memory).outcomes(workers)


def _here(items: Iterable[Any], task: Task, told: Listener) -> Iterator[Outcome]:
    for item in items:
        try:
            outcome = Outcome(item, task(item, partial(told, item)))
        except Exception as error:
            outcome = Outcome(item, error=error)
        yield outcome


class _Pool:
    """Threads, one for each process, that take items and put what they hear into one queue."""

    def __init__(
        self, items: Iterator[Any], task: tuple[Any, tuple[Any, ...]], told: Listener, memory: int | None
    ) -> None:
        self._items, self._task, self._told = items, pickle.dumps(task), told
        self._taking, self._heard = threading.Lock(), queue.SimpleQueue[Any]()
        self._processes: set[subprocess.Popen[bytes]] = set()
        self._memory, self._greedy = memory, set[int]()
        self._over = False

    def outcomes(self, workers: int) -> Iterator[Outcome]:
        """All outcomes."""
        threads = [threading.Thread(target=self._serve, daemon=True) for _ in range(workers)]
        for thread in threads:
            thread.start()
        if self._memory is not None:
            threading.Thread(target=self._watch, args=(self._memory,), daemon=True).start()
        try:
            while any(thread.is_alive() for thread in threads) or not self._heard.empty():
                try:
                    heard = self._heard.get(timeout=_PATIENCE)
                except queue.Empty:
                    continue
                if isinstance(heard, Outcome):
                    yield heard
                elif isinstance(heard, BaseException):
                    raise heard
                else:
                    self._told(*heard)
        finally:
            self._end(threads)

    def _end(self, threads: list[threading.Thread]) -> None:
        self._over = True
        with suppress(AttributeError, ValueError):  # who waits for an item is told that there is none
            self._items.close()  # type: ignore[attr-defined]
        for process in list(self._processes):
            process.kill()
        for thread in threads:
            thread.join()

    def _watch(self, most: int) -> None:
        """End processes that take too much."""
        while not self._over:
            for process in list(self._processes):
                if resident_memory(process.pid) > most:
                    self._greedy.add(process.pid)
                    process.kill()
            time.sleep(_GLANCE)

    def _next(self) -> Iterator[Any]:
        """One item, or none."""
        with self._taking:
            if not self._over:
                for item in self._items:
                    yield item
                    return

    def _serve(self) -> None:
        process = None
        try:
            while taken := list(self._next()):
                process = self._settled(taken[0], process)
        except BaseException as error:
            self._heard.put(error)
        finally:
            if process is not None:
                self._leave(process)

    def _settled(self, item: Any, process: subprocess.Popen[bytes] | None) -> subprocess.Popen[bytes] | None:
        """Have one item done; returns the process for the next one."""
        for attempt in range(1, _ATTEMPTS + 1):
            process = self._started() if process is None else process
            try:
                self._heard.put(self._outcome(item, process))
            except (EOFError, OSError, pickle.UnpicklingError):
                ended = self._leave(process)
                process = None
                if self._over:
                    return None
                if attempt == _ATTEMPTS or ended.startswith(_TOO_MUCH):
                    self._heard.put(Outcome(item, lost=ended))
            else:
                return process
        return process

    def _outcome(self, item: Any, process: subprocess.Popen[bytes]) -> Outcome:
        source, target = process.stdout, process.stdin
        assert source is not None
        assert target is not None
        pickle.dump(item, target)
        target.flush()
        while True:
            kind, content = pickle.load(source)
            if kind == "done":
                return Outcome(item, content)
            if kind == "raised":
                return Outcome(item, error=content)
            self._heard.put((item, *content))

    def _started(self) -> subprocess.Popen[bytes]:
        pipe = subprocess.PIPE
        process = subprocess.Popen([sys.executable, "-c", _START], stdin=pipe, stdout=pipe, start_new_session=True)
        self._processes.add(process)
        if self._over:  # since the item was taken
            process.kill()
        assert process.stdin is not None
        try:
            pickle.dump(sys.path, process.stdin)
            process.stdin.write(self._task)
            process.stdin.flush()
        except OSError:
            pass  # it is dead already, which the first item will show
        return process

    def _leave(self, process: subprocess.Popen[bytes]) -> str:
        """Let a process end, and say how it did."""
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                with suppress(OSError):
                    stream.close()
        status = process.wait()
        self._processes.discard(process)
        if process.pid in self._greedy:
            self._greedy.discard(process.pid)
            return f"{_TOO_MUCH} {(self._memory or 0) / 1e9:g} GB"
        return f"by signal {-status}" if status < 0 else f"with status {status}"
