"""XML as a stream of elements; nothing in it can name a file or swell."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from orbiframe import FormatError

Start = Callable[[str, dict[str, str], int], None]
Text = Callable[[str], None]
End = Callable[[str], None]


def parse(path: Path, data: bytes, start: Start, text: Text, end: End, *, whole: bool = True) -> None:
    """Call `start` with name, attributes and line of every element, `text` with its characters, and `end`.

    whole: whether the data ends as XML; else what is left open at its end is no error.

    Prefixes of names are taken away. A document type is passed over; what it names is never opened. Raises FormatError
    with the line for what is no XML, and for entities.
    """
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def refuse(*_: object) -> NoReturn:
        line = parser.CurrentLineNumber
        raise FormatError(f"{path}, line {line}: XML with entities is not read; take them out")

    parser.EntityDeclHandler = refuse
    parser.SkippedEntityHandler = refuse
    parser.ExternalEntityRefHandler = refuse
    parser.StartElementHandler = lambda name, attributes: start(_local(name), attributes, parser.CurrentLineNumber)
    parser.CharacterDataHandler = text
    parser.EndElementHandler = lambda name: end(_local(name))
    try:
        parser.Parse(data, whole)
    except expat.ExpatError as error:
        raise FormatError(
            f"{path}, line {error.lineno}: this is no sound XML: {expat.ErrorString(error.code)}"
        ) from error
    except (LookupError, ValueError) as error:
        raise FormatError(f"{path}: this is no sound XML: {error}") from error


def _local(name: str) -> str:
    return name.rpartition(":")[2]
