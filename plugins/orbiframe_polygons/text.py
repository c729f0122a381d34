"""Text: the lines of a file as one table of bytes, so that all their numbers are read at once."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from orbiframe import FormatError
from orbiframe_polygons.floats import LARGE, NUMBER, parsed

Bytes = NDArray[np.uint8]
Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

NEWLINE, BLANK, CONTINUED = 10, 32, 11
# The byte order mark of UTF-8.
MARK = b"\xef\xbb\xbf"
FEW = 100


@dataclass(frozen=True, slots=True)
class Text:
    """The lines of a text file that are not blank; words are separated by blanks.

    data: the bytes of the file; begin, end: the byte of the first word of each line and the byte after the line;
    number: the line number in the file; words: how many words the line has.
    """

    path: Path
    data: Bytes
    begin: Ints
    end: Ints
    number: Ints
    words: Ints

    def __len__(self) -> int:
        return len(self.begin)

    @property
    def first(self) -> Ints:
        """Index of the first word of each line among all words."""
        return np.cumsum(self.words) - self.words

    def lines(self, first: int, last: int) -> Text:
        """The lines first to last - 1 of the table."""
        begin, end = self.begin[first:last], self.end[first:last]
        start, stop = (int(begin[0]), int(end[-1])) if len(begin) else (0, 0)
        number, words = self.number[first:last], self.words[first:last]
        return Text(self.path, self.data[start:stop], begin - start, end - start, number, words)

    def only(self, wanted: Bools) -> Text:
        """The marked lines, with their bytes moved together."""
        rows = np.flatnonzero(wanted)
        if not len(rows) or rows[-1] - rows[0] + 1 == len(rows):
            return self.lines(rows[0], rows[-1] + 1) if len(rows) else self.lines(0, 0)
        begin, end = self.begin[rows], self.end[rows]
        marks = np.zeros(len(self.data) + 2, dtype=np.int8)
        marks[begin] += 1
        marks[end + 1] -= 1
        data = np.append(self.data, np.uint8(NEWLINE))[np.cumsum(marks[:-1], dtype=np.int8).view(np.bool_)]
        size = end - begin
        begin = np.cumsum(size + 1) - (size + 1)
        return Text(self.path, data, begin, begin + size, self.number[rows], self.words[rows])

    def without_keyword(self, length: int) -> Text:
        """The same lines without their first word, of a known length."""
        data = self.data.copy()
        for k in range(length):
            data[self.begin + k] = BLANK
        return replace(self, data=data, begin=self.begin + length, words=self.words - 1)

    def without_first_word(self) -> Text:
        """The same text without its first word."""
        if self.words[0] == 1:
            return self.lines(1, len(self))
        begin, words = self.begin.copy(), self.words.copy()
        rest = self.line(0).split(None, 1)[1]
        begin[0], words[0] = self.end[0] - len(rest), words[0] - 1
        return replace(self, begin=begin, words=words)

    def without_start(self, length: int) -> Text:
        """The same text without the first bytes of its first word, which is longer."""
        begin = self.begin.copy()
        begin[0] += length
        return replace(self, begin=begin)

    def line(self, row: int) -> bytes:
        """The bytes of one line, from its first word on."""
        return self.data[self.begin[row] : self.end[row]].tobytes()

    def numbers(self) -> Floats:
        """All words of all lines as finite numbers, in one array. Raises FormatError with the line of a bad word."""
        if not len(self):
            return np.empty(0)
        values = parsed(self.data[int(self.begin[0]) : int(self.end[-1])], int(self.words.sum()))
        if values is None:
            self._blame()
        finite = np.isfinite(values)
        if not finite.all():
            bad = np.flatnonzero(~finite)
            row = int(np.searchsorted(self.first, bad[0], side="right")) - 1
            word = self.line(row).split()[int(bad[0] - self.first[row])]
            self.refuse(row, f"found {shown(word)}, but a finite decimal number is required")
        return values

    def refuse(self, row: int, complaint: str) -> NoReturn:
        """Raise FormatError with the file and the line."""
        raise FormatError(f"{self.path}, line {self.number[row]}: {complaint}")

    def _blame(self) -> NoReturn:
        if len(self) > FEW:
            for half in (self.lines(0, len(self) // 2), self.lines(len(self) // 2, len(self))):
                half.numbers()
        for row in range(len(self)):
            for word in self.line(row).split():
                if not NUMBER.fullmatch(word):
                    self.refuse(row, f"found {shown(word)}, but a finite decimal number is required")
        raise FormatError(f"{self.path}: the numbers cannot be read; is this a text file?")


def read_text(path: Path, *, continued: bool = False) -> Text:
    """The lines of a file that are left when comments (from # to the end of the line) are taken away.

    A byte order mark is dropped; lines end with LF, CRLF or CR; continued: a backslash at the end of a line joins it to
    the next. Raises FormatError for UTF-16 and for bytes that are no text.
    """
    data = plain(path, path.read_bytes())
    if b"#" in data:
        data = re.sub(rb"#[^\n]*", b"", data)
    if continued and b"\\\n" in data:
        data = data.replace(b"\\\n", b" \v")
    return table(path, data)


def plain(path: Path, data: bytes, *, line: int = 1) -> bytes:
    """The bytes of a text without byte order mark, and with LF at the end of each line.

    line: the number of the first line. Raises FormatError for UTF-16 and for zero bytes.
    """
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise FormatError(f"{path}: the text is UTF-16; save it as UTF-8")
    return with_line_feeds(path, data.removeprefix(MARK), line=line)


def with_line_feeds(path: Path, data: bytes, *, line: int = 1) -> bytes:
    """A part of a text, from a line on, with LF at the end of each line. Raises FormatError for zero bytes."""
    if b"\0" in data:
        line += data[: data.index(b"\0")].count(b"\n")
        raise FormatError(f"{path}, line {line}: found a zero byte, but a text file is required; is the file binary?")
    return data.replace(b"\v", b" ").replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def table(path: Path, data: bytes, *, line: int = 1) -> Text:
    """The lines of a text that are not blank; line: the number of the first line."""
    codes = np.frombuffer(data, dtype=np.uint8)
    _require_printable(path, codes, line)
    begin, end, number, words = (_found_compiled if len(data) >= LARGE else _found)(codes)
    return Text(path, codes, begin, end, number + line, words)


def _require_printable(path: Path, codes: Bytes, line: int) -> None:
    # Unsigned bytes: those below the blank, but for the five that are blanks themselves, from tabulator to return.
    wrong = (codes < BLANK) & (codes - np.uint8(9) > 4)
    if wrong.any():
        at = int(wrong.argmax())
        line += int(np.isin(codes[:at], (NEWLINE, CONTINUED)).sum())
        raise FormatError(f"{path}, line {line}: found the control byte {codes[at]}, but a text file is required")


def _found(codes: Bytes) -> tuple[Ints, Ints, Ints, Ints]:
    """The lines that are not blank: first word, end, number of line ends before, and how many words."""
    starts = codes > BLANK
    starts[1:] &= codes[:-1] <= BLANK
    newlines = np.flatnonzero(codes == NEWLINE)
    begin = np.concatenate([[0], newlines + 1])
    word = np.flatnonzero(starts)
    words = np.diff(np.searchsorted(word, begin), append=len(word))
    number = np.arange(len(begin)) + np.searchsorted(np.flatnonzero(codes == CONTINUED), begin)
    filled = words > 0
    first = (np.cumsum(words) - words)[filled]
    end = np.append(newlines, len(codes))[filled]
    return word[first], end, number[filled], words[filled]


def _found_compiled(codes: Bytes) -> tuple[Ints, Ints, Ints, Ints]:
    from orbiframe_polygons.compiled_numbers import find_lines

    room = np.count_nonzero(codes == NEWLINE) + 1
    found = tuple(np.empty(room, dtype=np.intp) for _ in range(4))
    rows = find_lines(codes, *found)
    begin, end, number, words = (column[:rows] for column in found)
    return begin, end, number, words


def named(name: str) -> str:
    """A name of a file as it may stand in a sentence without quotes, if it is a plain one."""
    return name if name.isascii() and name.isprintable() and len(name) <= 40 else shown(name.encode(errors="replace"))


def shown(word: bytes) -> str:
    """A word of a file as it may stand in a sentence: quoted, decoded and not too long."""
    text = word[:40].decode("utf-8", errors="replace")
    return repr(text + "…" if len(word) > 40 else text)
