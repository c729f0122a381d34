"""What a study costs beside its fits, and what it keeps when it is killed: `python benchmarks/studies.py [NAME …]`.

overhead: milliseconds of the runner for each fit, where fits take no time, in this process and through others;
workers: fits a second with two processes against one; killed: a study of 200 fits, killed ten times; maps: forty bases
on one mesh; memory: what a thousand meshes leave behind; cluster: a scheduler and two workers, fits a second.
"""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

ROOT = Path(__file__).parents[1]
QUICK = """
[study]
meshes = ["{mesh}"]

[fitter]
name = "least-squares"

[output]
refine = 1

"""


@contextmanager
def study(tables: str, mesh: str = "cube.off") -> Iterator[Path]:
    """A study file in a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "study.toml"
        path.write_text(QUICK.format(mesh=(ROOT / "datasets" / mesh).as_posix()) + tables)
        yield path


def sizes(count: int, first: int = 10) -> str:
    """A sweep of so many sizes."""
    return f"[sweep]\nbasis.size = {list(range(first, first + count))}\n"


def run(path: Path, *arguments: object) -> dict[str, Any]:
    """Run a study by the command, and return what it says, with the seconds that all took."""
    command = [sys.executable, "-m", "orbiframe", "run", str(path), "--json", *map(str, arguments)]
    begun = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if not done.stdout:
        raise SystemExit(done.stderr)
    return {**json.loads(done.stdout), "wall": time.perf_counter() - begun}


def table(path: Path) -> bytes:
    """The table of a study."""
    return (path.with_suffix("") / "table.jsonl").read_bytes()


def overhead() -> None:
    """What the runner costs where a fit costs nothing."""
    from orbiframe_studies import one_fit
    from orbiframe_studies.plan import Plan
    from orbiframe_studies.runner import processes, run_study
    from orbiframe_studies.study_file import read_study
    from orbiframe_studies.study_folder import opened

    from orbiframe import Registry

    report = {"fit": {"rms": 0.1, "max": 0.2, "size": 10}, "seconds": {"fit": 0.0}, "versions": {}}
    one_fit._fitted = lambda *_: SimpleNamespace(report=report)
    for count in (200, 2000):
        with study(sizes(count)) as path:
            begun, used = time.perf_counter(), time.process_time()
            plan = Plan(read_study(path), Registry.discover())
            with opened(path.with_suffix(""), "study", path) as folder:
                found = run_study(plan.study, plan, folder, processes(1), SimpleNamespace(work=lambda *_: None))
            wall, own = time.perf_counter() - begun, time.process_time() - used
        each = [f"{1000 * seconds / count:.2f} ms" for seconds in (wall, own)]
        print(f"overhead  {found.new} fits: {each[0]} a fit, {each[1]} of the processor")


def through_processes() -> None:
    """What it costs to send a fit to another process and to have its row back."""
    from orbiframe.workers import work

    items, begun = 2000, 0.0
    for number, _ in enumerate(work(range(items), _nothing, workers=2)):
        begun = begun or time.perf_counter()
        last = number
    print(f"processes {1000 * (time.perf_counter() - begun) / last:.2f} ms for an item there and back")


def _nothing() -> Callable[[Any, Any], Any]:
    return lambda item, _: {"row": item, "report": {"number": [0.1] * 100}}


def workers() -> None:
    """Fits a second with one process and with two, taken in turn."""
    count, rates = 60, {1: [], 2: []}
    for _ in range(2):
        for number in (1, 2):
            with study(sizes(count, 100), "plate_genus2_coarse.off") as path:
                found = run(path, "--workers", number)
                rates[number].append(count / found["seconds"])
    ratio = max(rates[2]) / max(rates[1])
    load = os.getloadavg()[0]
    told = ", ".join(f"{number}: {' '.join(f'{rate:.2f}' for rate in each)}" for number, each in rates.items())
    print(f"workers   fits a second with {told}; {ratio:.2f} times, load {load:.1f}")


def killed() -> None:
    """A study of 200 fits, killed ten times at random, and one that is left alone."""
    choice = random.Random(0)
    with study(sizes(200)) as path:
        alone = run(path, "--workers", 2)
        whole, kept = table(path), path.with_name("alone")
        path.with_suffix("").rename(kept)
        journal = path.with_suffix("") / "journal.jsonl"
        for _ in range(10):
            process = subprocess.Popen(
                [sys.executable, "-m", "orbiframe", "run", str(path), "--workers", "2", "--quiet"]
            )
            before = _lines(journal)
            while process.poll() is None and _lines(journal) < before + 5:
                time.sleep(0.02)
            time.sleep(choice.uniform(0, 1))
            process.kill()
            process.wait()
        cut = _lines(journal)
        last = run(path, "--workers", 2)
        print(
            f"killed    ten times, with {cut} of 200 fits done; {last['new']} more, "
            f"table {'the same' if table(path) == whole else 'ANOTHER'} as that of {alone['new']} fits in one go"
        )


def _lines(path: Path) -> int:
    return path.read_bytes().count(b"\n") if path.exists() else 0


def maps() -> None:
    """Forty bases on one mesh."""
    widths = [round(1.2 + number / 40, 3) for number in range(40)]
    with study(f"[basis]\nsize = 100\n[sweep]\nbasis.width = {widths}\n", "plate_genus2_coarse.off") as path:
        found = run(path, "--workers", 2)
        print(f"maps      {found['fits']} bases with 2 workers: {found['maps']} map computed")


def memory() -> None:
    """What a thousand meshes leave behind in the process that fits them."""
    from orbiframe.cli.main import main
    from orbiframe.workers import resident_memory

    with tempfile.TemporaryDirectory() as folder:
        meshes = []
        for number in range(1000):
            meshes.append(str(Path(folder) / f"cube{number}.off"))
            Path(meshes[-1]).write_bytes((ROOT / "datasets" / "cube.off").read_bytes())
        common = ["--into", f"{folder}/out", "--size", "20", "--refine", "1", "--fast", "--quiet"]
        sizes, begun = [], time.perf_counter()
        for start, stop in ((0, 100), (100, 200), (200, 1000)):
            main(["fit", *meshes[start:stop], *common])
            sizes.append(resident_memory(os.getpid()) / 1e6)
        seconds = time.perf_counter() - begun
    print(f"memory    {', '.join(f'{size:.0f} MB' for size in sizes)} after 100, 200 and 1000 meshes, {seconds:.0f} s")


def cluster() -> None:
    """Fits a second of a scheduler with two workers on this machine."""
    with study(sizes(60, 100), "plate_genus2_coarse.off") as path:
        found = run(path, "--scheduler", "local", "--workers", 2)
        print(f"cluster   {60 / found['seconds']:.2f} fits a second, with the start of scheduler and workers")


ALL = {
    "overhead": overhead,
    "processes": through_processes,
    "maps": maps,
    "workers": workers,
    "killed": killed,
    "memory": memory,
    "cluster": cluster,
}


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    for name in sys.argv[1:] or ALL:
        ALL[name]()
