"""No reader opens a file that it was not given: every open of every reader is traced, in the confined processes too."""

from __future__ import annotations

import ctypes
import gzip
import json
import os
import struct
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from corpus.bad_files import cases
from traps import CANARY, traps

from orbiframe.components.registry import Registry

# Loaded by every Python process that starts in the environment: all its opens go to one file.
TRACER = """
import os, sys
_log = os.open(os.environ["OPENS"], os.O_WRONLY | os.O_APPEND)
def _listen(event, arguments):
    if event in ("open", "os.listdir", "os.scandir", "socket.connect", "os.system", "subprocess.Popen"):
        os.write(_log, (event + "\\t" + repr(arguments[0]) + "\\n").encode("utf-8", "replace"))
sys.addaudithook(_listen)
"""
READ = """
import json, sys, warnings
from pathlib import Path
from orbiframe import FormatError, PluginError, UsageError
from orbiframe.files import gate
from orbiframe.components.registry import Registry
warnings.simplefilter("ignore")
registry = Registry.discover()
for path, format in json.load(sys.stdin):
    try:
        gate.read(Path(path), registry, format=format)
        print(json.dumps([path, "read"]))
    except (FormatError, PluginError, UsageError) as error:
        print(json.dumps([path, str(error)]))
"""


@pytest.fixture
def canary(tmp_path):
    """A file that is a mesh of many formats at once, so that whoever follows a path would be glad of it."""
    folder = tmp_path / CANARY
    folder.mkdir()
    place = folder / "canary.bin"
    place.write_bytes(bytes(36))
    return place


def traced(tmp_path: Path, files: list[tuple[Path, str | None]]) -> tuple[dict[str, str], list[str]]:
    """What each file gives when read in a process of its own, and what that process and its children opened."""
    tools = tmp_path / "tools"
    tools.mkdir(exist_ok=True)
    (tools / "sitecustomize.py").write_text(TRACER)
    log = tools / "opens"
    log.write_text("")
    environment = os.environ | {"PYTHONPATH": str(tools), "OPENS": str(log)}
    given = json.dumps([[str(path), format] for path, format in files])
    run = subprocess.run(
        [sys.executable, "-c", READ], input=given, capture_output=True, text=True, env=environment, check=True
    )
    outcomes = dict(json.loads(line) for line in run.stdout.splitlines())
    return outcomes, log.read_text().splitlines()


def strangers(opens: list[str], tmp_path: Path, files: list[Path]) -> list[str]:
    """What was opened in our folders beside the files themselves, and any connection."""
    own = (
        {repr(str(path)) for path in files}
        | {repr(path) for path in files}
        | {repr(os.fsencode(path)) for path in files}
    )
    ours = [
        line
        for line in opens
        if str(tmp_path) in line or f"{CANARY}/canary" in line or line.startswith(("socket", "os.system"))
    ]
    return [line for line in ours if line.partition("\t")[2] not in own and "/tools" not in line]


class Watch:
    """Whether a file was opened by anybody, C libraries included: inotify of Linux."""

    def __init__(self, path: Path) -> None:
        library = ctypes.CDLL(None, use_errno=True)
        self.handle = library.inotify_init1(os.O_NONBLOCK)
        assert self.handle >= 0
        assert library.inotify_add_watch(self.handle, os.fsencode(path), 0x20) >= 0  # IN_OPEN

    def opened(self) -> bool:
        try:
            return len(os.read(self.handle, struct.calcsize("iIII") + 256)) > 0
        except BlockingIOError:
            return False


def placed(tmp_path: Path, content: list[tuple[str, bytes]]) -> list[Path]:
    folder = tmp_path / "files"
    folder.mkdir()
    paths = []
    for name, data in content:
        paths.append(folder / name)
        paths[-1].write_bytes(data)
    return paths


linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="inotify is of Linux")


@linux
def test_no_trap_opens_the_canary(tmp_path, canary):
    paths = placed(tmp_path, list(traps(canary)))
    watch = Watch(canary)
    outcomes, opens = traced(tmp_path, [(path, None) for path in paths])
    assert not watch.opened()
    assert len(outcomes) == len(paths) > 110
    assert strangers(opens, tmp_path, paths) == []
    assert all(f"{CANARY}/canary.bin" not in line for line in opens if line.startswith("open"))


@linux
@pytest.mark.parametrize("library", ["meshio", "open3d"])
def test_no_trap_opens_the_canary_by_a_library_that_is_named(tmp_path, canary, library):
    if find_spec(library) is None:
        pytest.skip(f"{library} is not installed")
    wanted = {
        "meshio": ("include 0.inp", "include 3.inp", "include 0.dato", "item 0.xdmf", "other.med", "call.obj"),
        "open3d": ("key twice.glb", "key with an escape.glb", "uri 0.gltf", "material.obj", "picture.fbx", "text.fbx"),
    }[library]
    paths = placed(tmp_path, [trap for trap in traps(canary) if trap[0] in wanted])
    watch = Watch(canary)
    outcomes, opens = traced(tmp_path, [(path, library) for path in paths])
    assert not watch.opened()
    assert len(outcomes) == len(paths) == len(wanted)
    assert strangers(opens, tmp_path, paths) == []
    assert any(f"site-packages/{library}" in line for line in opens)  # the confined process is heard too


@linux
def test_every_reader_over_the_corpus_opens_its_file_alone(tmp_path, canary):
    suffixes = [s for c in Registry.discover().components("reader") if c.name != "open3d" for s in c.suffixes]
    files = [(case.name.replace("/", " "), case.content) for case in cases()]
    content = files[0][1]
    others = [(f"wrong{suffix}", data) for suffix in suffixes for data in (content[:200],)]
    packed = [(f"{name}.gz", gzip.compress(data)) for name, data in files[::40]]
    paths = placed(tmp_path, [*files, *others, *packed])
    outcomes, opens = traced(tmp_path, [(path, None) for path in paths])
    assert len(outcomes) == len(paths) > 300
    assert strangers(opens, tmp_path, paths) == []
    # The tracer hears: every file itself was opened.
    assert sum(repr(str(path)) in "".join(opens) for path in paths[:20]) == 20


@linux
def test_the_watch_and_the_tracer_see_what_is_opened(tmp_path, canary):
    watch = Watch(canary)
    assert not watch.opened()
    canary.read_bytes()
    assert watch.opened()
    link = placed(tmp_path, [("a.off", b"OFF 1 1 1")])[0]
    _, opens = traced(tmp_path, [(link, None), (canary.with_name("canary.bin"), "off")])
    assert strangers(opens, tmp_path, [link])
