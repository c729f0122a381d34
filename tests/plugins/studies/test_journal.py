"""The journal survives whatever happens to it."""

from __future__ import annotations

import json
import resource
import signal

import pytest
from orbiframe_studies.journal import Journal

from orbiframe import FormatError


def entry(key: str, status: str = "done", **more):
    return {"key": key, "status": status, "error": None, "timing": {"total": 1.0}, **more}


def test_entries_come_back_and_the_last_of_a_key_counts(tmp_path):
    path = tmp_path / "journal.jsonl"
    with Journal(path) as journal:
        journal.add(entry("a", "failed"))
        journal.add(entry("b", report={"fit": {"rms": 0.25}}))
        journal.add(entry("a", more="later"))
        assert journal.status("a") == "done"
    with Journal(path) as journal:
        assert (len(journal), journal.damaged) == (2, 0)
        assert journal["a"]["more"] == "later"
        assert journal["b"]["report"] == {"fit": {"rms": 0.25}}
        assert journal.get("c") is None
        journal.forget("a")
        assert "a" not in journal


@pytest.mark.parametrize(
    "damage",
    [
        b'{"key": "b", "status": "do',
        b"\xff\xfe\n",
        b"[" * 100_000 + b"\n",
        b'{"key": 3, "status": "done", "timing": {}}\n',
        b'{"key": "b", "status": "what", "timing": {}}\n',
        b"null\n",
    ],
    ids=["half", "no text", "deep", "no key", "no status", "null"],
)
def test_half_a_line_was_never_written(tmp_path, damage):
    path = tmp_path / "journal.jsonl"
    first = json.dumps(entry("a")).encode() + b"\n"
    path.write_bytes(first + damage)
    with Journal(path) as journal:
        assert (list(journal.keys()), journal.damaged) == (["a"], 1)
        journal.add(entry("c"))
    with Journal(path) as journal:
        assert list(journal.keys()) == ["a", "c"]
        assert journal["c"]["key"] == "c"


def test_a_last_line_that_only_lacks_its_end_is_whole(tmp_path):
    path = tmp_path / "journal.jsonl"
    path.write_text(json.dumps(entry("a")))
    for _ in range(2):
        with Journal(path) as journal:
            journal.add(entry("b"))
            assert (list(journal.keys()), journal.damaged) == (["a", "b"], 0)


def test_a_full_disk_is_said_and_leaves_a_whole_journal(tmp_path):
    path = tmp_path / "journal.jsonl"
    with Journal(path) as journal:
        journal.add(entry("a"))
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        old = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size + 10, before[1]))
        try:
            with pytest.raises(FormatError, match=r"journal\.jsonl cannot be written.*run the study again"):
                journal.add(entry("b"))
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
            signal.signal(signal.SIGXFSZ, old)
        journal.add(entry("c"))
    with Journal(path) as journal:
        assert (list(journal.keys()), journal.damaged) == (["a", "c"], 0)
