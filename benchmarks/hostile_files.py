"""Mesh files changed at random: `python benchmarks/hostile_files.py --count 12000`.

Files of every format are changed by bytes, by words and by lines, archives and binary glTF inside as well, and read
in a process that is watched. A violation is a reader that takes more than 25 seconds or 2 GB, opens another file, or
ends in anything but a sound polyhedron or a sentence that names the file. Violations are kept in a folder (--keep), and
the status is 1. The same seed gives the same files.
"""

from __future__ import annotations

import argparse
import gzip
import importlib.util
import io
import multiprocessing
import os
import random
import re
import struct
import sys
import tempfile
import time
import warnings
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import numpy as np
from small_meshes import CUBE, QUADS, TRIANGLES
from traps import traps

from orbiframe import Polyhedron
from orbiframe.components.registry import Registry
from orbiframe.errors import FormatError, PluginError
from orbiframe.files import gate
from orbiframe.files.soundness import require_sound

SECONDS, MEMORY = 25.0, 2 * 2**30
# Readers that start a process for every file are tried so much less often.
SLOW, SELDOM = (".avs", ".vol", ".post", ".dato", ".su2", ".ugrid", ".fbx"), 40
BARE = re.compile(r"reading failed|\b[A-Z]\w+(?:Error|Exception)\b")
NUMBERS = ("nan", "inf", "-1", "0", "1e400", "-0", "1e308", "2147483648", "4294967295", "9223372036854775808",
           "99999999999999999999", "0x10", "1d3", "1.5", "", "1_000", "²", "٣", "\ufeff1", "9" * 400)  # fmt: skip
WORDS = (
    "SYSTEM", "INCLUDE", "*INCLUDE", "GRDSET", "BaseOffset", "Dimensions", "uri", "buffer", "scene", "transform",
    "unit", "inch", "POLYGONS", "METADATA", "$Periodic", "End", "Vertices", "ZONE", "VARSHARELIST", "component", "item",
    "AppendedData", "element", "list", "format", "\x00", "\x1b[31m", "../canary/canary.bin", "file:///etc/passwd",
    "<!DOCTYPE a>", "&b;", "%n", "{}", "[" * 99, "Piece",
)  # fmt: skip
BYTES = (b"\0", b"\xff", b"\r", b"\n", b"\t", b"\x80", b"\xff\xff\xff\xff", b"\0\0\0\x80", b"\x7f", b"/", b"\\",
         b'"', b"<", b">", b"{")  # fmt: skip


# ---- files to begin with ------------------------------------------------------------------------------------------


def seeds(folder: Path) -> dict[str, list[bytes]]:
    """Files by suffix: what the writers make of a cube and of a coloured one, and the files that name others."""
    registry, found = Registry.discover(), {}
    coloured = Polyhedron.from_corners(
        np.array(CUBE, float), np.arange(13) * 3, np.array(TRIANGLES).ravel(), normals=np.array(CUBE) - 0.5,
        colors=np.full((8, 4), 0.2), face_colors=np.full((12, 3), 0.4),
    )  # fmt: skip
    made = [Polyhedron.from_faces(np.array(CUBE, float), QUADS), coloured]
    made.append(made[0].with_vertices(made[0].vertices * [1, 1, 0]))
    for component in registry.components("writer"):
        for suffix in component.suffixes:
            found.setdefault(suffix, []).extend(_written(folder / f"a{suffix}", made, registry))
    for name, content in _by_hand():
        found.setdefault(Path(name).suffix, []).append(content)
    found[".gz"] = [gzip.compress(content) for content in found[".off"]]
    found[".zip"] = [_zip({"mesh.off": found[".off"][0], "readme.txt": b"hello"})]
    known = {s for c in registry.components("reader") for s in c.suffixes}
    for name, content in traps(folder / "canary" / "canary.bin"):
        # As many good files as such that name others, or more.
        if (suffix := Path(name).suffix) in known and content:
            found.setdefault(suffix, []).insert(0, content)
            found[suffix].append(found[suffix][-1])
    return {suffix: contents for suffix, contents in sorted(found.items()) if suffix in known and contents}


def _written(path: Path, made: list[Polyhedron], registry: Registry) -> Iterator[bytes]:
    for mesh in made:
        for options in ({}, {"ascii": True}):
            try:
                gate.write(path, mesh, registry, options=options)
            except Exception:
                continue
            yield path.read_bytes()


# Modules of tests, the suffix of their files, and the constants that hold them.
BY_HAND = (
    ("abaqus", ".inp", ("FLAT", "PART")), ("nastran", ".bdf", ("PLAIN",)), ("gmsh", ".msh", ("V1", "V2", "V40", "V41")),
    ("medit", ".mesh", ("PLAIN",)), ("tecplot", ".dat", ("PLAIN",)), ("vtk", ".vtk", ("PLAIN", "GRID")),
    ("xdmf", ".xdmf", ("PLAIN", "MIXED")),
)  # fmt: skip


def _by_hand() -> Iterator[tuple[str, bytes]]:
    """Files of our tests, whose formats have more than our writers use."""
    from corpus.bad_files import cases

    for case in cases():
        if len(case.content) < 5000 and hash_of(case.name) % 9 == 0:
            yield case.name, case.content
    plugins = Path(__file__).parents[1] / "tests" / "plugins" / "polygons"
    for name, suffix, constants in BY_HAND:
        module = _module(plugins / f"test_{name}.py")
        for constant in constants:
            yield f"{name}{suffix}", getattr(module, constant).encode()
        if name == "abaqus":
            yield "assembly.inp", module.assembly("", "1., 2., 3.\n0., 0., 0., 0., 0., 1., 90.\n").encode()
        if name == "medit":
            yield from ((f"binary{k}.meshb", module.binary("<>"[k % 2], 1 + k)) for k in range(4))
        if name == "vtk":
            yield "text.vtp", module.xml().encode()
    module = _module(plugins / "test_collada.py")
    yield "scene.dae", module.scene(module.NODE.replace("<inst", "<rotate>0 0 1 90</rotate><inst")).encode()


def _module(path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def hash_of(name: str) -> int:
    """A number of a name that is the same in every process."""
    return sum((k + 1) * ord(letter) for k, letter in enumerate(name))


def _zip(files: dict[str, bytes]) -> bytes:
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return memory.getvalue()


# ---- changes ------------------------------------------------------------------------------------------------------


def changed(content: bytes, suffix: str, rng: random.Random) -> bytes:
    """The content after one to four changes, inside what packs it most of the time."""
    if rng.random() < 0.8:
        inner = _unpacked(content, suffix)
        if inner is not None:
            parts, pack = inner
            name = rng.choice(sorted(parts))
            return pack(parts | {name: _several(parts[name], rng)})
    return _several(content, rng)


def _several(content: bytes, rng: random.Random) -> bytes:
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 4))):
        content = rng.choice(CHANGES)(content, rng)[: 2**20]
    return content


def _unpacked(content: bytes, suffix: str) -> tuple[dict[str, bytes], Callable[[dict[str, bytes]], bytes]] | None:
    """The parts of a container and what packs them again; None for a plain file or a damaged one."""
    try:
        if suffix in (".3mf", ".zip"):
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                return {name: archive.read(name) for name in archive.namelist()}, _zip
        if suffix == ".gz":
            return {"": gzip.decompress(content)}, lambda parts: gzip.compress(parts[""])
        if content.startswith(b"glTF"):
            length = struct.unpack_from("<I", content, 12)[0]
            rest = content[20 + length :]
            return {"": content[20 : 20 + length]}, lambda parts: _glb(parts[""], rest)
    except (zipfile.BadZipFile, OSError, EOFError, struct.error, RuntimeError, NotImplementedError):
        return None
    return None


def _glb(text: bytes, rest: bytes) -> bytes:
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest


def _span(content: bytes, rng: random.Random) -> tuple[int, int]:
    first = rng.randrange(len(content) + 1)
    return first, min(len(content), first + rng.choice((0, 1, 1, 2, 4, 8, 50)))


def _bytes(content: bytes, rng: random.Random) -> bytes:
    first, last = _span(content, rng)
    return content[:first] + rng.choice((*BYTES, rng.randbytes(rng.choice((1, 2, 4, 8))))) + content[last:]


def _cut(content: bytes, rng: random.Random) -> bytes:
    return content[: rng.randrange(len(content) + 1)]


def _repeat(content: bytes, rng: random.Random) -> bytes:
    first, last = _span(content, rng)
    return content[:first] + content[first:last] * rng.choice((2, 3, 1000)) + content[last:]


def _drop(content: bytes, rng: random.Random) -> bytes:
    first, last = _span(content, rng)
    return content[:first] + content[last:]


def _line(content: bytes, rng: random.Random) -> bytes:
    lines = content.splitlines(keepends=True) or [b""]
    at, to = rng.randrange(len(lines)), rng.randrange(len(lines))
    what = rng.choice(("drop", "twice", "swap", "move"))
    if what == "drop":
        del lines[at]
    elif what == "twice":
        lines.insert(to, lines[at])
    elif what == "swap":
        lines[at], lines[to] = lines[to], lines[at]
    else:
        lines.insert(to, lines.pop(at))
    return b"".join(lines)


TOKEN = re.compile(rb'"[^"\n]{0,99}"|[^\s,"<>=/{}\[\]:]+')


def _token(content: bytes, rng: random.Random) -> bytes:
    found = list(TOKEN.finditer(content[: 2**18]))
    if not found:
        return content
    token = rng.choice(found)
    new = rng.choice((*NUMBERS, *WORDS)).encode() if rng.random() < 0.7 else rng.choice(found)[0]
    if token[0].startswith(b'"') and rng.random() < 0.7:
        new = b'"' + new.strip(b'"') + b'"'
    return content[: token.start()] + new + content[token.end() :]


def _number(content: bytes, rng: random.Random) -> bytes:
    found = list(re.finditer(rb"[+-]?\d+(?:\.\d+)?", content[: 2**18]))
    if not found:
        return content
    number = rng.choice(found)
    return content[: number.start()] + rng.choice(NUMBERS).encode() + content[number.end() :]


CHANGES = (_bytes, _bytes, _cut, _repeat, _drop, _line, _line, _token, _token, _token, _number, _number)


# ---- reading ------------------------------------------------------------------------------------------------------


def work(pipe: Connection, folder: str) -> None:
    """Read the files whose names come through the pipe; for each send what happened."""
    import resource

    warnings.simplefilter("ignore")
    registry = Registry.discover()
    opened: list[str] = []
    given = [Path("/nowhere")]

    def listen(event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open" and isinstance(arguments[0], (str, bytes)):
            name = os.fsdecode(arguments[0])
            beside = name.startswith(f"{folder}/files/") and name.endswith(".bin")  # half of a .gltf
            if (
                not beside
                and (folder in name or "canary/canary.bin" in name or name.startswith("/etc/passwd"))
                and name != str(given[0])
            ):
                opened.append(name)

    sys.addaudithook(listen)
    pages = int(Path("/proc/self/statm").read_text().split()[0]) if Path("/proc/self/statm").exists() else 0
    limit = MEMORY + pages * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (limit, resource.getrlimit(resource.RLIMIT_AS)[1]))
    while True:
        given[0] = Path(pipe.recv())
        opened.clear()
        pipe.send((_outcome(given[0], registry), list(opened)))


def _outcome(path: Path, registry: Registry) -> str:
    try:
        found = gate.read(path, registry)
        require_sound(found, path)
    except (FormatError, PluginError) as error:
        said = str(error)
        if path.name not in said or BARE.search(said) or "more memory than there is" in said or not said.isprintable():
            return f"a bare message: {said}"
        return "refused"
    except BaseException as error:
        return f"{type(error).__name__}: {error}"
    return "read"


class Reader:
    """A process that reads, begun anew where it does not answer in time."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, other = context.Pipe()
        self._process = context.Process(target=work, args=(other, str(self._folder)), daemon=True)
        self._process.start()

    def outcome(self, path: Path) -> str:
        """read, refused, or the violation."""
        try:
            self._pipe.send(str(path))
            if not self._pipe.poll(SECONDS):
                self.stop()
                self._start()
                return f"no answer in {SECONDS:g} seconds"
            said, opened = self._pipe.recv()
        except (EOFError, OSError):
            self._start()
            return "the process ended"
        return f"opened {opened[:3]}" if opened else str(said)

    def stop(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()


def main() -> int:
    """Try the files; print a table, and the violations."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--suffixes", nargs="+", metavar="SUFFIX", help="only these")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="where files that violate are kept")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="hostile-") as name:
        bad = run(args, Path(name))
    return 1 if bad else 0


def run(args: argparse.Namespace, folder: Path) -> int:
    """How many files violate."""
    rng = random.Random(args.seed)
    (folder / "canary").mkdir()
    (folder / "canary" / "canary.bin").write_bytes(bytes(168))
    (folder / "files").mkdir()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        begun = {s: c for s, c in seeds(folder).items() if not args.suffixes or s in args.suffixes}
    weights = [1 if suffix in SLOW else SELDOM for suffix in begun]
    reader, outcomes, bad, start = Reader(folder), Counter[tuple[str, str]](), [], time.monotonic()
    slowest = (0.0, "")
    for k in range(args.count):
        suffix = rng.choices(list(begun), weights)[0]
        path = folder / "files" / f"{k}{'.off' if suffix == '.gz' else ''}{suffix}"
        path.write_bytes(changed(rng.choice(begun[suffix]), suffix, rng))
        before = time.monotonic()
        said = reader.outcome(path)
        slowest = max(slowest, (time.monotonic() - before, path.name))
        if said not in ("read", "refused"):
            bad.append((path.name, said))
            print(f"{path.name}: {said[:300]}", flush=True)
            if args.keep is not None:
                args.keep.mkdir(parents=True, exist_ok=True)
                (args.keep / path.name).write_bytes(path.read_bytes())
        outcomes[suffix, said if said in ("read", "refused") else "violation"] += 1
        path.unlink()
    reader.stop()
    print("| suffix | read | refused | violations |\n|---|---|---|---|")
    for suffix in begun:
        counts = [str(outcomes[suffix, kind]) for kind in ("read", "refused", "violation")]
        print(f"| {' | '.join([suffix, *counts])} |")
    took = f"{args.count} files in {time.monotonic() - start:.0f} s, the slowest {slowest[0]:.1f} s ({slowest[1]})"
    print(f"{took}; {len(bad)} violations")
    return len(bad)


if __name__ == "__main__":
    sys.exit(main())
