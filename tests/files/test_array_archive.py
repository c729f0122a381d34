"""Archives of arrays: what numpy writes is read, and members of another length than they say are not."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from orbiframe.files.array_archive import ArrayArchive

TABLE = np.arange(12.0).reshape(3, 4)


def packed(table: np.ndarray) -> bytes:
    memory = io.BytesIO()
    np.save(memory, table)
    return memory.getvalue()


def archive(path: Path, **members: bytes) -> Path:
    with zipfile.ZipFile(path, "w") as file:
        for name, content in members.items():
            file.writestr(f"{name}.npy", content)
    return path


@pytest.mark.parametrize("table", [TABLE, np.asfortranarray(TABLE), TABLE.astype(">f4"), np.array("words"), TABLE[:0]])
def test_arrays_are_those_that_numpy_has_written(tmp_path: Path, table: np.ndarray) -> None:
    with ArrayArchive(archive(tmp_path / "a.npz", table=packed(table))) as opened:
        found = opened.read("table")
    np.testing.assert_array_equal(found, table)
    assert found.dtype == table.dtype.newbyteorder("=")


@pytest.mark.parametrize("change", [lambda c: c + b"\0", lambda c: c + bytes(9), lambda c: c[:-1], lambda c: c[:-40]])
def test_members_of_another_length_than_they_say_are_refused(tmp_path: Path, change) -> None:
    path = archive(tmp_path / "a.npz", table=change(packed(TABLE)))
    with ArrayArchive(path) as opened, pytest.raises(ValueError, match="'table' is not as long as its header says"):
        opened.read("table")


def test_a_member_that_is_far_longer_is_refused_before_it_is_read(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="'table' is not as long as its header says"):
        ArrayArchive(archive(tmp_path / "a.npz", table=packed(TABLE) + bytes(2**16 + 1)))
