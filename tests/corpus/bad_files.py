"""Files that lie, made here, each with the answer that it must get: its mesh, or an error with the place.

`python -m corpus.bad_files FOLDER`, in the folder `tests`, writes them all.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from corpus.answers import Case, Mesh, Refused
from corpus.obj_files import obj
from corpus.off_files import off
from corpus.other_files import other
from corpus.ply_binary_files import ply_binary
from corpus.ply_text_files import ply_text
from corpus.scene_files import scenes
from corpus.stl_files import stl_binary, stl_text

MAKERS = (off, obj, ply_text, ply_binary, stl_text, stl_binary, scenes, other)


def cases() -> Iterator[Case]:
    """All files, each name once."""
    for maker in MAKERS:
        yield from cases_of(maker)


def cases_of(maker: Callable[[], Iterable[tuple[str, str | bytes, Mesh | Refused | str]]]) -> Iterator[Case]:
    """The files of one maker."""
    for name, content, answer in maker():
        data = content.encode() if isinstance(content, str) else content
        stem, _, suffix = name.rpartition(".")
        reason = Refused(answer) if isinstance(answer, str) else answer
        yield Case(f"{stem}.{suffix}", data, reason)


def main(folder: Path) -> None:
    """Write all files into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for case in cases():
        (folder / case.name).write_bytes(case.content)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
