"""Hostile inputs: seeded changes to surface files and to configurations, each tried with bounds on time and memory.

    python benchmarks/hostile_inputs.py --count 8000

Counts four kinds of failure, all of which must be 0: an exception that is no sentence of ours, more than 25 seconds,
more than 2 GB, and a surface that is loaded from a changed file and has other values without a word. Each case has a
number that makes it again: `--seed 7 --only 123 --kind surface`.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from orbiframe import Config, OrbiframeError, Polyhedron, Registry, fit, load_surface, save_surface
from orbiframe.cli.main import main as command_line
from orbiframe.fitting import mapping
from orbiframe.testing.polyhedra import reference_polyhedra

SECONDS, MEMORY = 25, 2 * 2**30
SURFACES = {
    "double torus": [],
    "cube": [],
    "torus": ["basis.name=ps2"],
    "Klein bottle": ["basis.name=tensor-bspline"],
    "projective plane": ["basis.name=argyris"],
    "needles": [],
}
Outcome = str
Case = Callable[[np.random.Generator], Outcome]


# ---- surface files --------------------------------------------------------------------------------------------------


def make_surfaces(folder: Path, registry: Registry) -> list[Path]:
    """Fit and save the surfaces that are changed."""
    paths, meshes = [], reference_polyhedra() | {"needles": needles(300)}
    for number, (name, more) in enumerate(SURFACES.items()):
        config = Config.load(overrides=["basis.size=30", "output.refine=1", *more])
        paths.append(folder / f"surface{number}.npz")
        save_surface(fit(meshes[name], config, registry).surface, paths[-1])
    return paths


def needles(count: int) -> Polyhedron:
    """A double pyramid, whose needles are halved on their surface."""
    turn = 2 * np.pi * np.arange(count) / count
    rim = np.stack([np.cos(turn), np.sin(turn), np.zeros(count)], axis=1)
    ring, after = np.arange(count), np.roll(np.arange(count), -1)
    sides = [np.stack(pair, axis=1) for pair in ((ring, after, ring * 0 + count), (after, ring, ring * 0 + count + 1))]
    return Polyhedron.from_faces(np.concatenate([rim, [[0, 0, 1], [0, 0, -1]]]), np.concatenate(sides))


def values_of(path: Path, registry: Registry) -> bytes:
    """Values and normals of a loaded surface at fixed points, as bytes."""
    surface = load_surface(path, registry)
    rng = np.random.default_rng(0)
    face = rng.integers(surface.refinement.coarse.face_count, size=50)
    points = surface.points(face, rng.dirichlet([1, 1, 1], size=50))
    return bytes(surface.evaluate(points).tobytes()) + surface.normals(points).tobytes()


def changed_arrays(rng: np.random.Generator, arrays: dict[str, np.ndarray]) -> None:
    """Change one to three arrays."""
    for _ in range(int(rng.integers(1, 4))):
        name = list(arrays)[rng.integers(len(arrays))]
        if name == "about":
            arrays[name] = np.array(changed_words(rng, str(arrays[name])))
        else:
            arrays[name] = changed_array(rng, arrays[name], arrays)


def changed_array(rng: np.random.Generator, a: np.ndarray, arrays: dict[str, np.ndarray]) -> np.ndarray:
    """Another array: other entries, length, order, type or shape."""
    kind = int(rng.integers(10))
    if kind <= 3 and a.size:
        b = a.copy()
        for _ in range(int(rng.integers(1, 4))):
            b.flat[rng.integers(b.size)] = special(rng, b)
        return b
    if kind == 4:
        with np.errstate(all="ignore"):
            return np.asarray(a * rng.choice([-1, 0, 1e-300, 1e300, 2, np.nan]))
    if kind == 5 and a.ndim:
        return a[: rng.integers(len(a) + 1)] if rng.random() < 0.5 else np.concatenate([a, a])
    if kind == 6 and a.ndim:
        return a[rng.permutation(len(a))]
    if kind == 7:
        with np.errstate(all="ignore"):
            return a.astype(rng.choice(["f4", "f8", "i4", "i8", "u1", "bool", "S4", "U3", "c16", ">f8", ">i8"]))
    if kind == 8:
        return rng.choice([a.ravel, lambda: a[None], lambda: np.zeros(0), lambda: np.zeros((0, 3)), lambda: a.T])()
    return list(arrays.values())[rng.integers(len(arrays))]


def special(rng: np.random.Generator, a: np.ndarray) -> object:
    """An entry that a reader might not expect."""
    if a.dtype.kind == "f":
        return rng.choice([np.nan, np.inf, -np.inf, 0.0, -1.0, 1e300, 1e-300, float(a.flat[0]) * (1 + 1e-9)])
    if a.dtype.kind in "iu":
        return rng.choice([-1, 0, 1, len(a.ravel()), 2**31, 2**62, -(2**62)]).astype(a.dtype)
    return bool(rng.integers(2))


def changed_words(rng: np.random.Generator, text: str) -> str:
    """What a file says of itself, otherwise."""
    if rng.random() < 0.15:
        return damaged(rng, text.encode()).decode("latin-1")
    try:
        about = json.loads(text)
    except ValueError:
        about = None
    if not isinstance(about, dict) or not about:  # changed before
        return text
    key = list(about)[rng.integers(len(about))]
    if rng.random() < 0.2:
        del about[key]
    elif key == "options" and rng.random() < 0.7 and about[key] and isinstance(about[key], dict):
        about[key][list(about[key])[rng.integers(len(about[key]))]] = any_value(rng)
    else:
        about[key] = any_value(rng)
    return json.dumps(about)


def any_value(rng: np.random.Generator) -> object:
    """A value of any type."""
    values = [None, True, -1, 0, 1, 3, 10**9, 10**40, 0.5, -2.5, 1e300, float("nan"), "", "s2", "e2", "h2", "ps6"]
    values += ["gaussian", "x" * 1000, "\x1b[31m", [], [1, [2, [3]]], {}, {"a": {"b": 1}}, "../../etc/passwd"]
    return values[rng.integers(len(values))]


def damaged(rng: np.random.Generator, content: bytes) -> bytes:
    """Bytes turned, lost, added or cut."""
    data = bytearray(content)
    for _ in range(int(rng.integers(1, 6))):
        kind, place = rng.integers(4), int(rng.integers(len(data) + 1))
        if kind == 0 and place < len(data):
            data[place] ^= 1 << int(rng.integers(8))
        elif kind == 1:
            del data[place : place + int(rng.integers(1, 100))]
        elif kind == 2:
            data[place:place] = rng.bytes(int(rng.integers(1, 50)))
        elif len(data) > 4 and rng.random() < 0.2:
            del data[place:]
    return bytes(data)


def changed_member(rng: np.random.Generator, content: bytes) -> bytes:
    """An archive in which the header or the bytes of one array are others, with a check sum of zip that fits."""
    made = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        chosen = old.namelist()[rng.integers(len(old.namelist()))]
        for name in old.namelist():
            data = old.read(name)
            if name == chosen:
                data = damaged(rng, data[:128]) + data[128:] if rng.random() < 0.6 else damaged(rng, data)
            new.writestr(name, data)
    return made.getvalue()


def surface_case(
    rng: np.random.Generator, base: list[Path], folder: Path, registry: Registry, known: list[bytes]
) -> str:
    """Try a changed surface file."""
    number = int(rng.integers(len(base)))
    content, path = base[number].read_bytes(), folder / "changed.npz"
    kind = rng.random()
    sealed = True
    if kind < 0.15:
        path.write_bytes(damaged(rng, content))
    elif kind < 0.35:
        path.write_bytes(changed_member(rng, content))
    else:
        with np.load(base[number]) as archive:
            arrays = dict(archive)
        if sealed := rng.random() < 0.4:
            changed_arrays(rng, arrays)
        else:  # as the first version of the format, which has no check sums: laws only
            about = json.loads(str(arrays["about"]))
            about.pop("sha256")
            arrays["about"] = np.array(json.dumps({**about, "version": 1}))
            changed_arrays(rng, arrays)
        np.savez(path, **arrays)
    found = values_of(path, registry)
    return "loaded" if found == known[number] else "other values" if sealed else "other values, no sums"


# ---- configurations -------------------------------------------------------------------------------------------------

KEYS = {
    "mesh": ["format"],
    "group": ["method", "first", "second"],
    "marking": ["method", "bases"],
    "map": ["method", "weights", "even_areas", "metric"],
    "shape": ["method", "group", "area"],
    "basis": ["name", "size", "degree", "width", "reach", "radius", "counts", "knots_u", "derivatives", "condensed"],
    "fitter": ["name", "fairing", "ridge"],
    "output": ["refine", "tolerance"],
}
NAMES = ["gaussian", "ps2", "ps6", "dms", "bernstein", "wendland", "simplex", "tensor-bspline", "argyris", "zenisek"]
NAMES += ["auto", "mesh", "none", "lattice", "regular-polygon", "regular-faces", "equivariant", "harmonic", "sphere"]
NUMBERS = ["-1", "0", "1", "2", "3", "7", "40", "1000000", "1000000000", "9" * 30, "9" * 5000, "0.5", "1e-300", "-0.0"]
NUMBERS += ["1e9", "1e300", "1e400", "inf", "-inf", "nan", "0x10", "1_000", "true", "2020-01-01", "07:00:00"]


def any_text(rng: np.random.Generator) -> str:
    """A value as one writes it, sensible or not."""
    kind = int(rng.integers(8))
    if kind <= 2:
        return NUMBERS[rng.integers(len(NUMBERS))]
    if kind <= 4:
        return json.dumps(NAMES[rng.integers(len(NAMES))])
    if kind == 5:
        return "[" + ", ".join(any_text(rng) for _ in range(int(rng.integers(0, 4)))) + "]"
    if kind == 6:
        depth = int(rng.choice([3, 30, 300, 3000]))
        return "[" * depth + "]" * depth if rng.random() < 0.5 else "{a=" * depth + "1" + "}" * depth
    return [
        "'\x1b[31m'",
        "x" * 10_000,
        "'''a\nb'''",
        "",
        "=",
        "{}",
        "{a=1}",
        "\ud800".encode("utf-8", "ignore").decode(),
    ][rng.integers(8)]


def any_pair(rng: np.random.Generator) -> tuple[str, str]:
    """A table and a key, mostly such as there are."""
    table = list(KEYS)[rng.integers(len(KEYS))] if rng.random() < 0.95 else "x" * int(rng.choice([1, 10**5]))
    keys = KEYS.get(table, ["a"])
    return table, keys[rng.integers(len(keys))] if rng.random() < 0.95 else "y" * int(rng.choice([1, 10**5]))


def any_toml(rng: np.random.Generator) -> bytes:
    """A configuration, now and then damaged."""
    lines = []
    for _ in range(int(rng.integers(1, 5))):
        table, key = any_pair(rng)
        lines += [f"[{table}]" if rng.random() < 0.95 else f"[[{table}]]", f"{key} = {any_text(rng)}"]
    if rng.random() < 0.05:
        lines.insert(0, f"plugins = {any_text(rng)}")
    text = "\n".join(lines).encode(errors="surrogateescape")
    return damaged(rng, text) if rng.random() < 0.3 else text


def config_case(rng: np.random.Generator, mesh: Path, folder: Path) -> Outcome:
    """Try a configuration on the command line."""
    arguments = ["fit", str(mesh), "-o", str(folder / "out.ply"), "--quiet"]
    arguments += ["--set", "basis.size=30"] if rng.random() < 0.9 else []
    if rng.random() < 0.5:
        (folder / "c.toml").write_bytes(any_toml(rng))
        arguments += ["--config", str(folder / "c.toml")]
    for _ in range(int(rng.integers(0, 3))):
        table, key = any_pair(rng)
        arguments += ["--set", f"{table}.{key}={any_text(rng)}"]
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        status = command_line(arguments)
    words = said.getvalue()
    if "internal error" in words or status not in (0, 1, 2) or (status and not words.startswith("orbiframe: ")):
        raise RuntimeError(f"status {status}: {words[:500]} from {str(arguments)[:600]}")
    if len([line for line in words.splitlines() if not line.startswith("orbiframe: warning")]) > 1 or len(words) > 6000:
        raise RuntimeError(f"more than a sentence: {words[:500]} from {str(arguments)[:600]}")
    return f"status {status}"


# ---- trying them ----------------------------------------------------------------------------------------------------


def tried(cases: range, seed: int, case: Case) -> Iterator[tuple[int, dict[str, Any]]]:
    """The outcome of every case, in child processes that end at the first that takes too long."""
    start = cases.start
    while start < cases.stop:
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reading)
            _try_from(start, cases.stop, seed, case, writing)
            os._exit(0)
        os.close(writing)
        done = start
        with os.fdopen(reading, encoding="utf-8") as lines:
            for line in lines:
                done += 1
                yield done - 1, json.loads(line)
        _, status = os.waitpid(child, 0)
        if os.WIFSIGNALED(status):
            name = signal.Signals(os.WTERMSIG(status)).name
            outcome = "too long" if name in ("SIGALRM", "SIGPROF") else f"killed by {name}"
            yield done, {"outcome": outcome, "seconds": SECONDS}
            done += 1
        start = done


def _try_from(start: int, stop: int, seed: int, case: Case, writing: int) -> None:
    for number in (signal.SIGALRM, signal.SIGPROF):
        signal.signal(number, signal.SIG_DFL)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * resource.getpagesize() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit, resource.getrlimit(resource.RLIMIT_AS)[1]))
    for number in range(start, stop):
        begin = time.process_time()
        # Seconds of the processor, as other programs may run too; and ten times as many by the clock.
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        signal.alarm(10 * SECONDS)
        try:
            outcome: Outcome = case(np.random.default_rng([seed, number]))
        except OrbiframeError as error:
            # What asked for too much memory is no failure if it is refused by a sentence, but says so in its cause.
            outcome = "too much memory" if isinstance(error.__cause__, MemoryError) else "refused"
        except BaseException:
            outcome = "bare exception: " + traceback.format_exc(limit=-4)[-1500:]
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.alarm(0)
        entry = {"outcome": outcome, "seconds": time.process_time() - begin}
        os.write(writing, (json.dumps(entry) + "\n").encode())


FAILURES = ("bare exception", "too long", "killed", "too much memory", "other values")


def main() -> int:
    """Try all cases; the status is 1 if one failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=8000, help="cases of both kinds together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=["surface", "config"], help="only this kind")
    parser.add_argument("--only", type=int, help="only the case with this number")
    args = parser.parse_args()
    # Small maps are as easy to damage as large ones, and thousands of them are made and loaded.
    mapping._LEAST_VERTICES = 200
    registry, failed = Registry.discover(), 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        base = make_surfaces(folder, registry)
        known = [values_of(path, registry) for path in base]
        mesh = folder / "mesh.off"
        mesh.write_text("OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
        kinds: dict[str, Case] = {
            "surface": lambda rng: surface_case(rng, base, folder, registry, known),
            "config": lambda rng: config_case(rng, mesh, folder),
        }
        for kind in [args.kind] if args.kind else kinds:
            cases = (
                range(args.count // (1 if args.kind else 2)) if args.only is None else range(args.only, args.only + 1)
            )
            failed += _report(kind, tried(cases, args.seed, kinds[kind]), args.seed)
    return 1 if failed else 0


def _report(kind: str, outcomes: Iterator[tuple[int, dict[str, Any]]], seed: int) -> int:
    counts, failed, longest = Counter[str](), 0, 0.0
    for number, entry in outcomes:
        outcome = entry["outcome"]
        longest = max(longest, entry["seconds"])
        counts[outcome.partition(":")[0]] += 1
        if outcome != "other values, no sums" and outcome.startswith(FAILURES):
            failed += 1
            print(f"{kind} --seed {seed} --only {number}: {outcome}", flush=True)
    listed = ", ".join(f"{count} {outcome}" for outcome, count in counts.most_common())
    print(f"{kind}: {sum(counts.values())} cases, {failed} failures ({listed}); the longest took {longest:.1f} s")
    return failed


if __name__ == "__main__":
    sys.exit(main())
