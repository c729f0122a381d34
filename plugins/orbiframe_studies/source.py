"""Source: gives the fits of chains to whoever has time for one, and takes their rows back."""

from __future__ import annotations

import threading
from collections import defaultdict, deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from orbiframe_studies.plan import Chain, Fit

Row = dict[str, Any]


@dataclass(eq=False)
class _Open:
    """A chain under way: the fits it asked for, and the rows that are there."""

    chain: Chain
    fits: list[Fit] = field(default_factory=list)
    rows: dict[str, Row] = field(default_factory=dict)


class Source:
    """Fits to be done, in the order of the chains: no more chains are open than there are hands for them.

    known: the row of a key that is done already, or None. An iterator for several threads: it waits where the next
    fits depend on rows that are not there yet, and ends when all chains have.
    """

    def __init__(self, chains: Iterator[Chain], known: Callable[[str], Row | None]) -> None:
        self._chains, self._known = chains, known
        self._ready: deque[Fit] = deque()
        self._waiting: dict[str, list[_Open]] = defaultdict(list)
        self._changed, self._over = threading.Condition(), False
        self.ended, self.skipped, self.rows = 0, 0, 0

    def __iter__(self) -> Iterator[Fit]:
        return self

    def __next__(self) -> Fit:
        with self._changed:
            while True:
                fit = self._take()
                if fit is not None:
                    return fit
                if self._over or not self._waiting:
                    self._changed.notify_all()
                    raise StopIteration
                self._changed.wait()

    def take(self) -> Fit | None:
        """The next fit if there is one now."""
        with self._changed:
            return self._take()

    @property
    def finished(self) -> bool:
        """Whether all chains have ended; to be asked when `take` has given None."""
        return self._over or not self._waiting

    def close(self) -> None:
        """No more fits."""
        with self._changed:
            self._over = True
            self._changed.notify_all()

    def put(self, key: str, row: Row) -> None:
        """The row of a fit that has been given out; chains that wait for it go on."""
        with self._changed:
            for opened in self._waiting.pop(key, []):
                opened.rows[key] = row
                self._go_on(opened)
            self._changed.notify_all()

    def _take(self) -> Fit | None:
        while not self._over:
            if self._ready:
                return self._ready.popleft()
            chain = next(self._chains, None)
            if chain is None:
                return None
            self._begin(_Open(chain))
        return None

    def _begin(self, opened: _Open) -> None:
        opened.fits = next(opened.chain)
        self._ask(opened)
        self._go_on(opened)

    def _go_on(self, opened: _Open) -> None:
        """Send a chain its rows as long as all are there."""
        while all(fit.key in opened.rows for fit in opened.fits):
            self.rows += len(opened.fits)
            try:
                opened.fits = opened.chain.send([opened.rows[fit.key] for fit in opened.fits])
            except StopIteration:
                self.ended += 1
                return
            self._ask(opened)

    def _ask(self, opened: _Open) -> None:
        """Take the rows that are known, and have the other fits done, each once."""
        for fit in opened.fits:
            row = self._known(fit.key)
            if row is not None:
                opened.rows[fit.key] = row
                self.skipped += 1
            elif fit.key not in opened.rows:
                if fit.key not in self._waiting:
                    self._ready.append(fit)
                if opened not in self._waiting[fit.key]:
                    self._waiting[fit.key].append(opened)
