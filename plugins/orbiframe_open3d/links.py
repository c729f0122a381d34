"""Links: which further files a file names, since Open3D would open them."""

from __future__ import annotations

import json
import struct
from itertools import chain
from pathlib import Path

from orbiframe import FormatError

# Magic number, version and size of the file; size and kind of the first chunk.
START = struct.Struct("<4sIIII")
JSON = 0x4E4F534A
PICTURES = (b"RelativeFilename", b"FileName", b"Filename")


def require_own_files(path: Path) -> None:
    """Raise FormatError for a file that names others, but for the buffers of a .gltf, which are half of that format.

    Those must be files beside it, and no links.
    """
    content, suffix = path.read_bytes(), path.suffix.lower()
    if suffix == ".gltf":
        _require_near(path, content)
    if suffix == ".glb":
        _require_none(path, _text_of(path, content))
    if suffix == ".fbx" and any(name in content for name in PICTURES):
        raise FormatError(f"{path}: the file names pictures, which Open3D would open; save it without them")


def _text_of(path: Path, content: bytes) -> bytes:
    """The JSON of a binary glTF. Raises FormatError where its sizes do not fit."""
    if len(content) < START.size or not content.startswith(b"glTF"):
        raise FormatError(f"{path}: a binary glTF starts with 'glTF' and has {START.size} bytes at least")
    _, version, size, length, kind = START.unpack_from(content)
    if version != 2 or kind != JSON:
        raise FormatError(f"{path}, byte 4: this is no glTF of version 2 that starts with JSON")
    if size != len(content):
        raise FormatError(
            f"{path}, byte 8: the file should have {size} bytes, but has {len(content)}; is it cut short?"
        )
    if START.size + length > size:
        raise FormatError(f"{path}, byte 12: the JSON should have {length} bytes, but {size - START.size} are left")
    return content[START.size : START.size + length]


def _require_near(path: Path, text: bytes) -> None:
    buffers, images = _names(path, text)
    for name in buffers:
        if Path(name).name != name or ":" in name or "%" in name or (path.parent / name).is_symlink():
            raise FormatError(f"{path}: the file names {name[:80]!r}; only buffers in its own folder are opened")
    for name in images:
        raise FormatError(f"{path}: the file names the picture {name[:80]!r}, which is not opened; save it as .glb")


def _require_none(path: Path, text: bytes) -> None:
    for name in chain(*_names(path, text)):
        raise FormatError(f"{path}: the file names {name[:80]!r}, which is not opened; save it with all in one file")


def _names(path: Path, text: bytes) -> tuple[list[str], list[str]]:
    """The files that a glTF names as buffers and as pictures."""
    try:
        tree = json.loads(text)
        found = [[str(p["uri"]) for p in tree.get(key, []) if "uri" in p] for key in ("buffers", "images")]
    except (ValueError, TypeError, AttributeError, RecursionError) as error:
        raise FormatError(f"{path}: this is no glTF: {error}") from error
    buffers, images = ([name for name in names if not name.startswith("data:")] for names in found)
    return buffers, images
