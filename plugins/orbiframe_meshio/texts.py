"""Texts: what is looked at in a file beside meshio, which would follow paths or believe what is wrong."""

from __future__ import annotations

import io
import re
from pathlib import Path

from orbiframe import FormatError

XML = {".vtu", ".xml", ".svg", ".xdmf", ".xmf"}
# Formats on HDF5, netCDF and references to it.
CONTAINERS = {".xdmf", ".xmf", ".cgns", ".h5m", ".hmf", ".med", ".e", ".exo", ".ex2"}
NASTRAN = {".nas", ".bdf", ".fem"}
INCLUDE = re.compile(rb"^[ \t]*[*$]?[ \t]*include\b", re.IGNORECASE | re.MULTILINE)
INCLUDING = {".inp", ".post", ".dato", *NASTRAN}
ENTITY = re.compile(rb"<!(ENTITY|DOCTYPE)")
# The line with which a whole file ends.
ENDS = {".mesh": b"End", ".vol": b"endmesh", ".post": b"$FIN", ".dato": b"$FIN", **dict.fromkeys(NASTRAN, b"ENDDATA")}
# Keywords that meshio would pass over, of Permas and of SU2: all but those that it obeys, or that change nothing.
PERMAS = re.compile(
    rb"^(?!\$(?:COOR|STRUCTURE|FIN|(?:END|EXIT) \w+|ENTER COMPONENT[^\n]*|[NE]SET\b[^\n]*|ELEMENT TYPE *= *\w+)[ \t]*$)"
    rb"(?:\$|COOR|ELEMENT|NSET|ESET).*",
    re.MULTILINE | re.IGNORECASE,
)
SU2 = re.compile(
    rb"^[ \t]*(?!(?:NDIME|NELEM|NPOIN|NMARK|MARKER_TAG|MARKER_ELEMS|SEND_RECV)[ \t]*=)[^%=\n]*=.*", re.MULTILINE
)
KEYWORDS = {".post": PERMAS, ".dato": PERMAS, ".su2": SU2}
# Those that count once: meshio takes the last.
ONCE = {
    **dict.fromkeys((".post", ".dato"), re.compile(rb"^\$COOR.*", re.MULTILINE)),
    ".su2": re.compile(rb"^[ \t]*(?:NDIME|NPOIN|NELEM)\b", re.MULTILINE),
}
# Numbers of elements in SU2.
COUNT = re.compile(rb"^(?:NELEM|MARKER_ELEMS)[ \t]*=[ \t]*(\d{1,12})[ \t\r]*$", re.MULTILINE)
# meshio takes long over long lines, as it prints them.
LONGEST = 100_000
SHORT_LINED = {".su2", ".inp", ".avs", *ENDS}
SHOWN = 60


class EndingText(io.TextIOWrapper):
    """A text that ends: some readers of meshio ask for its next line for ever."""

    _asked = 0

    def readline(self, size: int | None = -1, /) -> str:  # type: ignore[override]
        """The next line. Raises EOFError where there is none, from the tenth time on."""
        line = super().readline(-1 if size is None else size)
        self._asked = 0 if line else self._asked + 1
        if self._asked > 9:
            raise EOFError("the file ends too early; is it cut short?")
        return line


def require_trustworthy(path: Path) -> None:
    """Raise FormatError for a file that may open others, is cut short, or holds what meshio would pass over."""
    suffix = path.suffix.lower()
    if suffix in CONTAINERS:
        raise FormatError(f"{path}: {suffix} files may name other files, so they are not read; save it as VTU or PLY")
    # Lines end where meshio, too, sees their ends.
    content = path.read_bytes().replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    if suffix in XML:
        _require_plain_xml(path, content)
    if suffix in SHORT_LINED:
        _require_short_lines(path, content)
    if suffix in INCLUDING:
        _refuse(path, content, INCLUDE, "the file includes another; only files that stand alone are read")
    if suffix in ENDS and not re.search(rb"^[ \t]*" + re.escape(ENDS[suffix]), content, re.MULTILINE):
        line = content.rstrip().count(b"\n") + 1
        raise FormatError(f"{path}, line {line}: the file ends without '{ENDS[suffix].decode()}'; is it cut short?")
    if suffix in KEYWORDS:
        _refuse(
            path, content, KEYWORDS[suffix], "this keyword is not known, or changes what others mean; it is not read"
        )
        _require_once(path, content, ONCE[suffix])
    if suffix == ".ugrid":
        _require_words(path, content)


def require_counts(path: Path, found: int) -> None:
    """Raise FormatError unless an SU2 file says that it has so many elements."""
    asked = sum(map(int, COUNT.findall(path.read_bytes().replace(b"\r", b"\n"))))
    if asked != found:
        raise FormatError(f"{path}: the counts say {asked} elements, but there are {found}; is the file cut short?")


def _refuse(path: Path, content: bytes, pattern: re.Pattern[bytes], complaint: str) -> None:
    found = pattern.search(content)
    if found:
        line = content.count(b"\n", 0, found.start()) + 1
        word = found[0].strip()[:SHOWN].decode("utf-8", errors="replace")
        raise FormatError(f"{path}, line {line}: found {word!r}; {complaint}")


def _require_once(path: Path, content: bytes, pattern: re.Pattern[bytes]) -> None:
    met: set[bytes] = set()
    for found in pattern.finditer(content):
        word = found[0].split()[0]
        if word in met:
            line = content.count(b"\n", 0, found.start()) + 1
            raise FormatError(
                f"{path}, line {line}: {word[:SHOWN].decode(errors='replace')} stands twice; one mesh is read"
            )
        met.add(word)


def _require_short_lines(path: Path, content: bytes) -> None:
    for number, line in enumerate(content.splitlines(), start=1):
        if len(line) > LONGEST:
            raise FormatError(
                f"{path}, line {number}: the line has {len(line)} bytes, but they are short in this format"
            )


def _require_plain_xml(path: Path, content: bytes) -> None:
    if not content.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        raise FormatError(f"{path}: the file does not start like XML in UTF-8; is it what its suffix says?")
    if ENTITY.search(content):
        raise FormatError(f"{path}: XML with a document type or entities is not read; take them out")


def _require_words(path: Path, content: bytes) -> None:
    """Raise FormatError unless a UGRID text has as many words as its seven counts ask for."""
    words = content.split()
    if len(words) < 7 or not all(word.isdigit() and len(word) < 12 for word in words[:7]):
        raise FormatError(f"{path}, line 1: seven counts are required; UGRID is read as text only")
    points, triangles, quads, *solids = map(int, words[:7])
    # Each face has its corners and a tag.
    asked = 7 + 3 * points + 4 * triangles + 5 * quads
    if not any(solids) and asked != len(words):
        raise FormatError(f"{path}, line 1: the counts ask for {asked} words, but the file has {len(words)}")
