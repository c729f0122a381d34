"""Files made for a test."""

from __future__ import annotations

from pathlib import Path


def written(path: Path, content: str | bytes) -> Path:
    """The path, after the content was written there as it is: a text in UTF-8, its ends of lines untouched."""
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path
