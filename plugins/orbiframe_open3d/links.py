"""Links: which further files a file names, since Open3D would open them."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

from orbiframe import FormatError

# Magic number, version and size of the file; size and kind of the first chunk.
START = struct.Struct("<4sIIII")
JSON = 0x4E4F534A
PICTURES = (b"RelativeFilename", b"FileName", b"Filename")


def require_own_files(path: Path) -> None:
    """Raise FormatError for a file that names others. A .gltf may always do so; the reader gltf reads it."""
    content, suffix = path.read_bytes(), path.suffix.lower()
    if suffix == ".gltf":
        raise FormatError(f"{path}: a .gltf may name other files, so Open3D does not read it; leave the format away")
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


def _require_none(path: Path, text: bytes) -> None:
    """Raise FormatError where any object of the JSON has an address of a file, or one key twice."""

    def look(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            raise ValueError("a key stands twice in one object")
        uri = found.get("uri", "data:")
        if not isinstance(uri, str) or not uri.startswith("data:"):
            raise FormatError(f"{path}: the file names {uri!r:.80}, which is not opened; save it with all in one file")
        return found

    try:
        tree = json.loads(text.decode("utf-8"), object_pairs_hook=look)
    except (ValueError, RecursionError) as error:
        raise FormatError(f"{path}: this is no glTF: {error}") from error
    if not isinstance(tree, dict):
        raise FormatError(f"{path}: this is no glTF: an object is required")
