"""Files of formats that nobody reads."""

from __future__ import annotations

from corpus.answers import Rows
from corpus.off_files import OFF


def other() -> Rows:
    yield "archive.off.gz", b"\x1f\x8b\x08" + b"\0" * 99, "no sound gzip"
    yield "archive.zip", b"PK\x03\x04" + b"\0" * 99, "no sound archive"
    yield "no suffix.", OFF, "no suffix|not known"
