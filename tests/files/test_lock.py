from __future__ import annotations

import subprocess
import sys

import pytest

from orbiframe.files import file_lock

TAKE = """
import sys
from pathlib import Path
from orbiframe.files import file_lock
with file_lock(Path(sys.argv[1]), wait=False) as mine:
    print(mine)
"""


def taken_elsewhere(path) -> str:
    return subprocess.run([sys.executable, "-c", TAKE, str(path)], capture_output=True, text=True, check=True).stdout


def test_a_lock_is_held_by_one_process_and_let_go(tmp_path):
    path = tmp_path / "lock"
    with file_lock(path) as mine:
        assert mine
        assert taken_elsewhere(path) == "False\n"
    assert taken_elsewhere(path) == "True\n"


def test_a_lock_needs_a_folder(tmp_path):
    with pytest.raises(FileNotFoundError), file_lock(tmp_path / "absent" / "lock"):
        pass
