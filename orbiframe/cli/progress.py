"""Progress on the standard error stream: stages with their seconds, and that functions are being compiled."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO

from orbiframe.cli.shares import FitShare, in_words
from orbiframe.cli.speech import say, say_event
from orbiframe.cli.status_line import status_line
from orbiframe.compiled import compilation

# Seconds after which something is said again.
_PATIENCE, _TICK = 1.5, 1.0
_BAR = 20
MODES = ("auto", "json", "none")


class Progress:
    """Shows how far the work is: in the last line of a terminal or notebook, as lines of JSON, or not at all.

    A command that waits for its user from now on, as a server does, calls `rest()`: no seconds are counted then.

    Called as `progress(stage, seconds)`, with None at the beginning of a stage and its seconds at the end; `work` is
    for many fits. While a stage goes on, something is said every second or so. mode: "auto", shown on terminals and in
    notebooks only, "json" or "none". See docs/reference/cli.md for the lines of JSON.
    """

    def __init__(self, stream: TextIO | None = None, *, quiet: bool = False, mode: str = "auto") -> None:
        stream = sys.stderr if stream is None else stream
        self.mode = "none" if quiet else mode
        self._line = status_line(stream) if self.mode == "auto" else None
        self._stage, self._began, self._share = "", 0.0, FitShare()
        self._work: tuple[int, int, str] | None = None
        self._command = ""
        self._work_began, self._done_before = 0.0, 0
        self._ticker: Ticker | None = None
        self.rest: Callable[[], None] = lambda: None

    @property
    def shown(self) -> bool:
        """Whether anything is said."""
        return self._line is not None or self.mode == "json"

    def __call__(self, stage: str, seconds: float | None) -> None:
        """Say that a stage begins, or how long it took."""
        if not self.shown:
            return
        if seconds is None:
            self._stage, self._began = stage, time.monotonic()
            self._share.begins(stage)
            self._tick_from_now()
        else:
            self._stage = ""
            self._share.ends(stage)
        if self._line is None:
            ended = {"seconds": round(seconds, 4)} if seconds is not None else {}
            self._json("stage", stage=stage, state="begins" if seconds is None else "ends", **ended, **self._estimate())
        elif seconds is None:
            self._line.show(f"{stage} …")
        else:
            self._line.leave(f"{stage:<16}{seconds:7.2f} s")

    def watch(self, command: str) -> None:
        """From now on to `close` a program learns that a command goes on, whether it tells its stages or not."""
        if self.mode == "json":
            self._command, self._began = command, time.monotonic()
            self._tick_from_now()

    def work(self, done: int, total: int, text: str = "") -> None:
        """Say that so many of so many fits are done; text: what is being done."""
        if not self.shown:
            return
        if self._work is None:
            self._work_began, self._done_before = time.monotonic(), done
        self._work = done, total, text
        self._tick_from_now()
        self._say_work()
        if done == total:
            self.close()

    def clear(self) -> None:
        """Make room for a line of another kind."""
        if self._line:
            self._line.wipe()

    def close(self) -> None:
        """Nothing goes on any more."""
        if self._ticker:
            self._ticker.stop()
            self._ticker = None
        if self._line and self._work:
            self._line.wipe()
        self._work, self._stage, self._command = None, "", ""

    def _say_work(self) -> None:
        if self._work is None:
            return
        done, total, text = self._work
        share = done / total if total else 1.0
        new, elapsed = done - self._done_before, time.monotonic() - self._work_began
        rest = elapsed * (total - done) / new if new > 0 else None
        if self._line is None:
            self._json("work", done=done, total=total, what=text, share=round(share, 4), left=_rounded(rest))
            return
        bar = "█" * round(_BAR * share)
        parts = [f"{bar:·<{_BAR}} {done} of {total}", f"{100 * share:.0f} %", in_words(rest), text]
        self._line.show(", ".join(filter(None, parts)))

    def _tick_from_now(self) -> None:
        if self._ticker is None:
            self._ticker = Ticker(self._tick)
        self._ticker.touch()

    def _tick(self) -> None:
        """Say that a stage goes on."""
        if self._work is not None:
            self._say_work()
        elif (self._stage or self._command) and self._line is None:
            spent = round(time.monotonic() - self._began, 1)
            self._json("alive", stage=self._stage or self._command, seconds=spent, **self._estimate())
        elif self._stage and self._line:
            percent = 100 * self._share.share
            parts = [f"{time.monotonic() - self._began:.0f} s", f"{percent:.0f} % of the fit done"]
            words = ", ".join(filter(None, [*parts, in_words(self._share.left)]))
            self._line.show(f"{self._stage} … {words}")
        elif self._ticker and not self._stage:
            self._ticker.stop()
            self._ticker = None

    def _estimate(self) -> dict[str, Any]:
        return {"share": round(self._share.share, 4), "left": _rounded(self._share.left)}

    def _json(self, event: str, **content: Any) -> None:
        say_event(event, **content)


def _rounded(seconds: float | None) -> float | None:
    return None if seconds is None else round(seconds, 1)


class Ticker:
    """Calls a function again and again, until it is stopped or nobody has touched it for long."""

    def __init__(self, tick: Callable[[], None]) -> None:
        self._tick, self._stopped, self._touched = tick, threading.Event(), time.monotonic()
        threading.Thread(target=self._go_on, daemon=True).start()

    def touch(self) -> None:
        """Something has been said just now."""
        self._touched = time.monotonic()

    def stop(self) -> None:
        """No more."""
        self._stopped.set()

    def _go_on(self) -> None:
        while not self._stopped.wait(_TICK):
            if time.monotonic() - self._touched >= _TICK / 2:
                self._tick()


class CompilationProgress:
    """Says that functions are being compiled: at once, and again while it goes on, with how many they are by then.

    On a terminal behind the text of the status line, elsewhere on lines of its own, of JSON where that is asked for.
    """

    def __init__(self, stream: TextIO | None, *, json: bool = False) -> None:
        self.count, self._json = 0, json
        self._line, self._done = status_line(stream), threading.Event()

    def begins(self, name: str) -> None:  # noqa: ARG002
        """Hear that a function is about to be compiled."""
        self.count += 1
        if self.count == 1:
            self._say("compiling, once on this machine …")
            threading.Thread(target=self._go_on, daemon=True).start()
        elif self._line:
            self._say_more()

    def ends(self) -> None:
        """Hear that no function is being compiled any more."""
        if self._line:
            self._line.remark("")

    def stop(self) -> None:
        """Say no more."""
        self._done.set()

    def _go_on(self) -> None:
        while not self._done.wait(_PATIENCE):
            if compilation.underway:
                self._say_more()

    def _say_more(self) -> None:
        self._say(f"compiling, once on this machine: {self.count} functions so far …")

    def _say(self, text: str) -> None:
        if self._json:
            say_event("compiling", functions=self.count)
        elif self._line:
            self._line.remark(text)
        else:
            say(text)


@contextmanager
def compilation_told(*, quiet: bool = False, json: bool = False) -> Iterator[CompilationProgress]:
    """Meanwhile whoever reads the standard error stream learns that functions are being compiled."""
    progress = CompilationProgress(sys.stderr, json=json)
    if quiet:
        yield progress
        return
    with compilation.heard(progress):
        try:
            yield progress
        finally:
            progress.stop()
