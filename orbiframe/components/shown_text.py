"""Shown text: words from files and names of files as a terminal may see them."""

from __future__ import annotations

import unicodedata

LONGEST = 2000
# Controls, formats such as those that turn the direction of writing, halves of pairs, and ends of lines.
_HIDDEN = {"Cc", "Cf", "Cs", "Zl", "Zp"}


def shown(text: str, longest: int = LONGEST) -> str:
    """The text in one line: what a terminal would obey is escaped, and the middle of an endless text left out."""
    if len(text) > longest:
        head, tail = text[: longest * 2 // 3], text[-longest // 3 :]
        text = f"{head} … ({len(text) - len(head) - len(tail)} characters) … {tail}"
    if text.isascii() and text.isprintable():
        return text
    return "".join(_escaped(letter) if unicodedata.category(letter) in _HIDDEN else letter for letter in text)


def _escaped(letter: str) -> str:
    return letter.encode("unicode_escape", errors="surrogatepass").decode("ascii")
