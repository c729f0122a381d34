"""Outputs: whole or not at all, through links, with modes kept, and nothing replaced that is not a file of ours."""

from __future__ import annotations

import os
import signal
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from orbiframe.errors import FormatError, UsageError
from orbiframe.files.outputs import output, require_apart, require_output, write_bytes, write_text
from orbiframe.files.temporary_folder import temporary_folder


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_new_file_has_the_usual_mode_and_nothing_else_is_left(tmp_path: Path) -> None:
    write_text(tmp_path / "a.json", "one")
    (tmp_path / "b").write_text("two")
    assert (tmp_path / "a.json").stat().st_mode == (tmp_path / "b").stat().st_mode
    assert names(tmp_path) == ["a.json", "b"]


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o755, 0o666])
def test_the_mode_of_what_is_replaced_is_kept(tmp_path: Path, mode: int) -> None:
    path = tmp_path / "a"
    path.write_text("old")
    path.chmod(mode)
    write_bytes(path, b"new")
    assert (path.read_bytes(), stat.S_IMODE(path.stat().st_mode)) == (b"new", mode)


def test_a_link_stays_and_the_file_behind_it_is_written(tmp_path: Path) -> None:
    (tmp_path / "behind").mkdir()
    link, target = tmp_path / "link", tmp_path / "behind" / "file"
    for content in (b"first", b"second"):
        link.unlink(missing_ok=True)
        link.symlink_to("behind/file")
        write_bytes(link, content)
        assert link.is_symlink()
        assert target.read_bytes() == content
    assert names(tmp_path / "behind") == ["file"]


@pytest.mark.parametrize("content", [b"", b"short", b"longer than what was there before"])
def test_other_names_of_a_file_keep_it(tmp_path: Path, content: bytes) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    one.write_bytes(b"what was there")
    os.link(one, other)
    if not content:
        with pytest.raises(FormatError, match="no file"):
            write_bytes(one, content)
        return
    write_bytes(one, content)
    assert other.read_bytes() == content
    assert one.samefile(other)


def pipe(path: Path) -> None:
    os.mkfifo(path)


def to_device(path: Path) -> None:
    path.symlink_to("/dev/null")


def folder(path: Path) -> None:
    path.mkdir()


def in_a_circle(path: Path) -> None:
    path.symlink_to(path.name)


@pytest.mark.parametrize("make", [pipe, to_device, folder, in_a_circle])
def test_what_is_no_file_is_never_replaced(tmp_path: Path, make: Callable[[Path], None]) -> None:
    path = tmp_path / "place"
    make(path)
    before = os.lstat(path)
    with pytest.raises(FormatError, match="place cannot be written"):
        write_bytes(path, b"x")
    assert os.lstat(path) == before
    assert names(tmp_path) == ["place"]


def test_devices_are_refused_by_name() -> None:
    with pytest.raises(FormatError, match=r"/dev/null cannot be written: it is a device"):
        require_output(Path("/dev/null"))
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


@pytest.mark.parametrize("place", ["absent/file", "file/below", "x" * 300, "a\0b"])
def test_places_that_cannot_be(tmp_path: Path, place: str) -> None:
    (tmp_path / "file").write_text("kept")
    with pytest.raises(FormatError, match="cannot be written"):
        write_bytes(tmp_path / place, b"x")
    assert names(tmp_path) == ["file"]


@pytest.mark.skipif(os.geteuid() == 0, reason="everything may be written by the superuser")
def test_a_file_that_may_not_be_changed_is_not(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_text("old")
    path.chmod(0o444)
    with pytest.raises(FormatError, match="may not be changed"):
        write_bytes(path, b"new")


def write_half(path: Path, error: BaseException) -> None:
    with output(path) as made:
        made.write_text("half")
        raise error


def test_an_error_in_between_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_text("old")
    for error in (OSError(28, "No space left on device"), KeyError("x"), KeyboardInterrupt()):
        with pytest.raises((FormatError, KeyError, KeyboardInterrupt)):
            write_half(path, error)
    assert path.read_text() == "old"
    assert names(tmp_path) == ["a"]


# ---- companions -----------------------------------------------------------------------------------------------------


def write_pair(path: Path, content: str) -> None:
    with output(path) as made:
        made.write_text(f'{{"uri": "{path.stem}.bin", "content": "{content}"}}')
        made.with_suffix(".bin").write_text(content)


def test_a_second_file_is_moved_along_and_replaced_with_the_first(tmp_path: Path) -> None:
    for content in ("one", "two"):
        write_pair(tmp_path / "mesh.gltf", content)
        assert (tmp_path / "mesh.bin").read_text() == content
    assert names(tmp_path) == ["mesh.bin", "mesh.gltf"]


@pytest.mark.parametrize("there", [None, "text of another program"])
def test_a_stranger_is_not_replaced(tmp_path: Path, there: str | None) -> None:
    (tmp_path / "mesh.bin").write_text("stranger")
    if there:
        (tmp_path / "mesh.gltf").write_text(there)
    before = names(tmp_path)
    with pytest.raises(FormatError, match=r"mesh\.gltf cannot be written: .*mesh\.bin beside it, which is there"):
        write_pair(tmp_path / "mesh.gltf", "ours")
    assert (tmp_path / "mesh.bin").read_text() == "stranger"
    assert names(tmp_path) == before


# ---- one file, several names ----------------------------------------------------------------------------------------


def test_one_file_by_two_names_is_refused(tmp_path: Path) -> None:
    (tmp_path / "mesh.off").write_text("OFF")
    (tmp_path / "link.ply").symlink_to("mesh.off")
    (tmp_path / "dangling").symlink_to("new.ply")
    (tmp_path / "folder").symlink_to(".")
    mesh = {"the input": tmp_path / "mesh.off", "--config": None}
    require_apart({"-o": tmp_path / "a", "--save": tmp_path / "b", "--report": None}, mesh)
    for outputs, said in (
        ({"-o": tmp_path / "mesh.off"}, "the input itself"),
        ({"-o": tmp_path / "link.ply"}, "the input itself"),
        ({"-o": tmp_path / "folder" / "mesh.off"}, "the input itself"),
        ({"-o": tmp_path / "a", "--save": tmp_path / "a"}, "named by -o and by --save"),
        ({"-o": tmp_path / "new.ply", "--save": tmp_path / "dangling"}, "named by -o and by --save"),
        ({"-o": tmp_path / "new.ply", "--save": tmp_path / "folder" / "new.ply"}, "named by -o and by --save"),
    ):
        with pytest.raises(UsageError, match=said):
            require_apart(outputs, mesh)


# ---- temporary folders ----------------------------------------------------------------------------------------------


def test_names_cannot_be_guessed_and_only_the_user_may_enter(tmp_path: Path) -> None:
    with temporary_folder(tmp_path) as one, temporary_folder(tmp_path) as other:
        assert one.name != other.name
        assert str(os.getpid()) not in (one.name, other.name)
        assert stat.S_IMODE(one.stat().st_mode) == 0o700
    assert names(tmp_path) == []


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_folders_go_where_a_signal_ends_the_process(tmp_path: Path, number: signal.Signals) -> None:
    code = """
import signal, sys, time
from pathlib import Path
from orbiframe.files.outputs import output
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where the tests run in the background
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # ignored where they outlive a terminal
with output(Path(sys.argv[1])) as made:
    made.write_text("half")
    print("at work", flush=True)
    time.sleep(60)
    print("went on")
"""
    command = [sys.executable, "-c", code, str(tmp_path / "file")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "at work\n"
        assert len(names(tmp_path)) == 1
        process.send_signal(number)
        assert process.stdout.read() == ""
    assert process.returncode == (-signal.SIGINT if number == signal.SIGINT else 128 + number)
    assert names(tmp_path) == []


def test_a_program_that_sees_to_signals_itself_is_left_alone(tmp_path: Path) -> None:
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN), signal.signal(signal.SIGHUP, signal.SIG_DFL)
    try:
        with temporary_folder(tmp_path):
            assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
            assert signal.getsignal(signal.SIGHUP) not in (signal.SIG_DFL, signal.SIG_IGN)
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_DFL
    finally:
        signal.signal(signal.SIGTERM, before[0])
        signal.signal(signal.SIGHUP, before[1])
