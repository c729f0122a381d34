"""Container: the JSON and the buffers of a glTF, in one file or with buffers beside it."""

from __future__ import annotations

import base64
import binascii
import os
import stat
import struct
from functools import cached_property
from pathlib import Path
from urllib.parse import unquote

from orbiframe import FormatError
from orbiframe_polygons.gltf.tree import Node, parsed

# Magic number, version and size of the file; size and kind of each chunk.
START, CHUNK = struct.Struct("<4sII"), struct.Struct("<II")
JSON, BINARY = 0x4E4F534A, 0x004E4942
# What the files of buffers are called; no other file is opened.
BUFFERS = (".bin", ".glbin", ".glbuf")
FORBIDDEN = set('/\\:?#*|<>"') | {chr(k) for k in range(32)}


class Container:
    """A glTF: its root, and its buffers by number; no buffer is opened before it is asked for."""

    def __init__(self, path: Path) -> None:
        self.path = path
        content = path.read_bytes()
        text, self._chunk = _chunks(path, content) if content.startswith(b"glTF") else (content, None)
        if not content.startswith(b"glTF") and path.suffix.lower() == ".glb":
            raise FormatError(f"{path}: a binary glTF starts with 'glTF'; is the file what its suffix says?")
        self.root = parsed(path, text)
        self._read: dict[int, bytes] = {}

    @cached_property
    def buffers(self) -> list[Node]:
        """The buffers as the JSON describes them."""
        return self.root.children("buffers")

    def buffer(self, number: int) -> bytes:
        """The bytes of a buffer, as many as are declared."""
        if number not in self._read:
            self._read[number] = self._bytes(number)
        return self._read[number]

    def _bytes(self, number: int) -> bytes:
        node = self.buffers[number]
        size = node.index("byteLength")
        data = self._source(node, number, size)
        if len(data) < size:
            node.refuse(f"{size} bytes are declared, but there are {len(data)}; is the file cut short?")
        return data[:size]

    def _source(self, node: Node, number: int, size: int) -> bytes:
        if not node.has("uri"):
            if number or self._chunk is None:
                node.refuse("the buffer has neither an address nor a chunk of bytes; is it compressed?")
            return self._chunk
        uri = node.word("uri")
        return _embedded(node, uri) if uri[:5].lower() == "data:" else _beside(node, uri, size)


def _chunks(path: Path, content: bytes) -> tuple[bytes, bytes | None]:
    """The JSON of a binary glTF, and its bytes if it has them. Raises FormatError where its sizes do not fit."""
    if len(content) < START.size + CHUNK.size:
        raise FormatError(f"{path}: a binary glTF has {START.size + CHUNK.size} bytes at least; is it cut short?")
    _, version, size = START.unpack_from(content)
    if version != 2:
        raise FormatError(f"{path}, byte 4: this is glTF of version {version}, but only version 2 is read")
    if size != len(content):
        raise FormatError(
            f"{path}, byte 8: the file should have {size} bytes, but has {len(content)}; is it cut short?"
        )
    chunks, at = [], START.size
    while at < len(content):
        if at + CHUNK.size > len(content):
            raise FormatError(f"{path}, byte {at}: the file ends inside a chunk; is it cut short?")
        length, kind = CHUNK.unpack_from(content, at)
        at += CHUNK.size
        if at + length > len(content):
            raise FormatError(f"{path}, byte {at - 8}: the chunk should have {length} bytes, but {size - at} are left")
        chunks.append((kind, content[at : at + length]))
        at += length
    kinds = [kind for kind, _ in chunks]
    if kinds[0] != JSON or kinds.count(JSON) > 1 or kinds.count(BINARY) > 1 or BINARY in kinds[2:]:
        raise FormatError(f"{path}, byte 12: a binary glTF has one chunk of JSON, then one of bytes at most")
    return chunks[0][1], dict(chunks).get(BINARY)


def _embedded(node: Node, uri: str) -> bytes:
    head, comma, body = uri.partition(",")
    if not comma or not head.lower().endswith(";base64"):
        node.refuse("the buffer stands in the JSON, but not as base64")
    try:
        return base64.b64decode(body.encode("ascii"), validate=True)
    except (binascii.Error, UnicodeEncodeError) as error:
        node.refuse(f"the buffer is no base64: {error}")


def _beside(node: Node, uri: str, size: int) -> bytes:
    """The bytes of a file in the same folder, which is half of this format; a link is not followed."""
    name = unquote(uri)
    if name.startswith((".", "~")) or FORBIDDEN & set(name) or not name.lower().endswith(BUFFERS):
        node.refuse(f"names {uri[:80]!r}; only buffers (.bin) in its own folder are opened")
    place = node.path.parent / name
    try:
        descriptor = os.open(place, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
    except (OSError, ValueError) as error:
        link = place.is_symlink()
        reason = "is a link, which is not followed" if link else f"cannot be opened: {getattr(error, 'strerror', '')}"
        node.refuse(f"the buffer {name[:80]!r} in its own folder {reason}")
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        node.refuse(f"names {name[:80]!r}, which is no regular file")
    with open(descriptor, "rb") as file:
        return file.read(size)
