"""Where machine code is kept, and whose code is trusted."""

from __future__ import annotations

import os
import stat
import tempfile
import warnings
from pathlib import Path

import pytest

from orbiframe.compiled import code_folders
from orbiframe.compiled.code_folders import read_code, write_code

POSIX = pytest.mark.skipif(not hasattr(os, "getuid"), reason="files have no owner here")


class Places:
    """A program, a home and a place for temporary files, all in one folder."""

    def __init__(self, folder: Path) -> None:
        self.source = folder / "program" / "module.py"
        self.beside = folder / "program" / "__pycache__"
        self.own = folder / "home" / ".cache" / "orbiframe"
        self.passing = folder / "temporary" / f"orbiframe-{os.getuid() if hasattr(os, 'getuid') else 'user'}"
        for parent in (self.source.parent, folder / "home", self.passing.parent):
            parent.mkdir()
        self.source.write_text("")

    def block(self, *folders: Path) -> None:
        """Make folders impossible, as in a read-only place: a file stands where one is to be."""
        for folder in folders:
            folder.parent.mkdir(parents=True, exist_ok=True)
            folder.write_text("")

    def write(self, content: bytes = b"code") -> list[str]:
        """Write, and return the warnings."""
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            write_code(self.source, "f.nbc", content)
        return [str(warning.message) for warning in caught]

    def read(self) -> list[bytes]:
        return list(read_code(self.source, "f.nbc"))


@pytest.fixture
def places(tmp_path, monkeypatch):
    monkeypatch.setattr(code_folders.sys, "platform", "linux")
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    code_folders._warn.cache_clear()
    yield Places(tmp_path)
    code_folders._warn.cache_clear()


def test_code_lies_beside_the_program(places):
    assert places.write() == []
    assert [file.name for file in places.beside.iterdir()] == ["f.nbc"]
    assert places.read() == [b"code"]


def test_code_of_a_read_only_program_lies_in_the_folder_of_the_user(places):
    places.block(places.beside)
    assert places.write() == []
    assert places.read() == [b"code"]
    assert len(list(places.own.iterdir())) == 1


def test_programs_in_one_folder_do_not_meet(places, tmp_path):
    places.block(places.beside)
    places.write()
    other = tmp_path / "other" / "module.py"
    other.parent.mkdir()
    other.write_text("")
    assert list(read_code(other, "f.nbc")) == []


def test_code_that_was_put_beside_the_program_before_it_became_read_only_serves(places):
    places.write()
    places.beside.chmod(0o555)
    assert places.read() == [b"code"]


def test_without_a_folder_of_the_user_code_lies_in_a_temporary_one_with_one_warning(places):
    places.block(places.beside, places.own.parent)
    said = places.write()
    assert len(said) == 1
    assert str(places.passing) in said[0]
    assert "NUMBA_CACHE_DIR" in said[0]
    assert places.write() == []
    assert places.read() == [b"code"]


@pytest.mark.parametrize("home", ["/dev/null", "relative"])
def test_a_home_that_is_none(places, monkeypatch, home):
    monkeypatch.setenv("HOME", home)
    places.block(places.beside)
    assert len(places.write()) == 1
    assert places.passing.exists()


def test_without_any_folder_nothing_is_kept_with_one_warning(places):
    places.block(places.beside, places.own.parent, places.passing)
    said = places.write()
    assert len(said) == 1
    assert "every run compiles again" in said[0]
    assert places.write() == []
    assert places.read() == []


def test_a_folder_that_the_user_names_comes_first(places, monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "named"))
    assert places.write() == []
    assert places.read() == [b"code"]
    assert not places.beside.exists()
    assert len(list((tmp_path / "named" / "orbiframe").iterdir())) == 1


def test_the_folder_for_such_files_that_the_system_names(places, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    places.block(places.beside)
    assert places.write() == []
    assert len(list((tmp_path / "xdg" / "orbiframe").iterdir())) == 1


@POSIX
def test_folders_of_the_user_are_closed_to_others(places):
    places.block(places.beside)
    places.write()
    assert stat.S_IMODE(places.own.stat().st_mode) == 0o700


@POSIX
def test_a_folder_that_others_may_write_to_is_not_trusted(places):
    """Neither read nor written: code in it would run with the rights of whoever reads it."""
    places.block(places.beside)
    places.write(b"evil")
    places.own.chmod(0o770)
    assert places.read() == []
    places.write(b"good")
    assert places.read() == [b"good"]
    assert len(list(places.passing.iterdir())) == 1


@POSIX
@pytest.mark.parametrize("folder", ["own", "passing"])
def test_a_folder_of_another_user_is_not_trusted(places, monkeypatch, folder):
    blocked = [places.beside] if folder == "own" else [places.beside, places.own.parent]
    places.block(*blocked)
    mine = os.getuid()
    taken = getattr(places, folder)
    monkeypatch.setattr(code_folders, "_temporary_folder", lambda: places.passing)
    places.write(b"evil")
    assert len(list(taken.iterdir())) == 1
    monkeypatch.setattr(os, "getuid", lambda: mine + 1)
    assert places.read() == []
    places.write(b"good")
    assert places.read() == []
    assert len(list(taken.iterdir())) == 1


@POSIX
def test_a_link_is_not_trusted(places, tmp_path):
    places.block(places.beside)
    places.write()
    elsewhere = tmp_path / "elsewhere"
    places.own.rename(elsewhere)
    places.own.symlink_to(elsewhere)
    assert places.read() == []


@POSIX
def test_beside_the_program_its_owner_is_trusted_and_all_the_world_is_not(places, monkeypatch):
    places.write()
    mine = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: mine + 1)
    assert places.read() == [b"code"]
    places.beside.chmod(0o777)
    assert places.read() == []


def test_a_full_disk_leaves_no_part_of_a_file(places, monkeypatch):
    write = Path.write_bytes

    def full(path, content):
        write(path, content[:1])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    assert len(places.write()) == 1
    assert list(places.beside.iterdir()) == []
