"""Faults planted one at a time, and whether the tests notice: `python benchmarks/mutants.py`, or `make mutants`.

Mutations are drawn by a seed, spread over folders, kinds and functions. Each is planted in a copy of the tree, and
tests run until one fails: those of its own file, then those beside it in its folder, then those elsewhere that enter
the changed function, each time the quickest first and for no longer than the limits below. What is done is kept in
`build/mutants` and not done again while the mutated file and the tests that decided stay as they are.

Mutants that change nothing that could be asked for are listed with the reason in `benchmarks/equivalent_mutants.toml`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from multiprocessing import get_context
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from mutant_tests import (
    Chooser,
    Records,
    compiled_functions,
    digest,
    functions_near,
    functions_of,
    sources,
    test_files,
)
from mutant_trials import ROOT, Tree, load_libraries
from mutations import Mutation, mutations

BUILD = ROOT / "build" / "mutants"
EQUIVALENT = Path(__file__).with_name("equivalent_mutants.toml")
# Seconds of tests, as recorded, that are tried on one mutant at most: beside its file, and elsewhere.
BESIDE, ELSEWHERE = 20.0, 10.0
STAGES = ("own tests", "folder", "elsewhere")
PLUGINS = ("bases", "parametrizers", "fitters", "polygons", "exact", "remeshing", "lagrange")
KERNEL = (
    "planes", "meshes", "words", "orbifolds", "groups", "triangulations", "delaunay", "functions", "splines",
    "surfaces", "components", "compiled", "files", "fitting",
)  # fmt: skip
COMMANDS = ("plugins/orbiframe_drawing/draw_command.py", "plugins/orbiframe_invariants/group_command.py")


@dataclass(frozen=True)
class Mutant:
    """A mutation of a file, by a key that outlives changes of other lines."""

    area: str
    path: str
    key: str
    mutation: Mutation

    @property
    def functions(self) -> frozenset[str]:
        """The recorded names of the functions whose tests may notice it."""
        if self.mutation.function in compiled_functions(self.path):
            return functions_near(self.path)
        name = f"{self.path}:{self.mutation.function}"
        known = functions_of(self.path)
        return frozenset({name} & known or {f for f in known if f.startswith(name)})

    @cached_property
    def stages(self) -> list[list[str]]:
        """The files of tests: its own, those beside it, those elsewhere."""
        parts = Path(self.path).with_suffix("").parts
        folder = f"tests/{parts[1].removeprefix('orbiframe_') if parts[0] == 'orbiframe' else _plugin_tests(parts[1])}"
        beside = [f for f in test_files() if f.startswith(f"{folder}/")]
        own = [f for f in beside if _is_named_for(parts[-1], Path(f).stem.removeprefix("test_"))]
        return [own, [f for f in beside if f not in own], [f for f in test_files() if f not in beside]]


def _plugin_tests(package: str) -> str:
    return f"plugins/{package.removeprefix('orbiframe_')}"


def _is_named_for(module: str, test: str) -> bool:
    """Whether a file of tests has the name of a module, or its first words, such as `off` for `off_reader`."""
    module = module.replace("threemf", "3mf")
    return module == test or module.startswith(f"{test}_") or test.startswith(f"{module}_")


def areas() -> dict[str, list[str]]:
    """The folders from which mutants are drawn, each with its sources."""
    found = {f"orbiframe/{name}": f"orbiframe/{name}/" for name in KERNEL}
    found |= {f"plugins/orbiframe_{name}": f"plugins/orbiframe_{name}/" for name in PLUGINS}
    left_out = ("__init__.py", "plugin.py")
    files = {area: [p for p in sources() if p.startswith(start)] for area, start in found.items()}
    files["commands"] = [p for p in sources() if p.startswith("orbiframe/cli/") or p in COMMANDS]
    return {area: [p for p in paths if Path(p).name not in left_out] for area, paths in files.items()}


def candidates(area: str, path: str) -> Iterator[Mutant]:
    """Every mutant of a file."""
    alike = Counter[tuple[str, str]]()
    for mutation in mutations((ROOT / path).read_bytes()):
        same = mutation.function, mutation.text
        yield Mutant(area, path, mutation.key(path, alike[same]), mutation)
        alike[same] += 1


def drawn(seed: int, count: int) -> list[Mutant]:
    """So many mutants, from each folder in proportion to the root of what could be changed there."""
    found = {area: [m for p in paths for m in candidates(area, p)] for area, paths in areas().items()}
    whole = sum(math.sqrt(len(mutants)) for mutants in found.values())
    return [
        mutant
        for area, mutants in found.items()
        for mutant in _spread(mutants, seed)[: max(3, round(count * math.sqrt(len(mutants)) / whole))]
    ]


def _spread(mutants: list[Mutant], seed: int) -> list[Mutant]:
    """In an order that takes the kinds in turn and each function once before any twice."""
    order = sorted(mutants, key=lambda m: hashlib.sha256(f"{seed} {m.key}".encode()).digest())
    of_kind, of_function = Counter[str](), Counter[tuple[str, str]]()
    turns = []
    for mutant in order:
        kind, function = mutant.mutation.kind, (mutant.path, mutant.mutation.function)
        turns.append((of_function[function], of_kind[kind]))
        of_kind[kind] += of_function[function] == 0
        of_function[function] += 1
    return [mutant for _, mutant in sorted(zip(turns, order, strict=True), key=lambda pair: pair[0])]


# ---- trials -----------------------------------------------------------------------------------------------------


def trial(mutant: Mutant, tree: Tree, records: Records) -> dict[str, Any]:
    """Plant a mutant, run tests until one fails, and say how it went."""
    source = (ROOT / mutant.path).read_bytes()
    result = {
        "key": mutant.key, "area": mutant.area, "path": mutant.path, "line": mutant.mutation.line,
        "function": mutant.mutation.function, "mutation": mutant.mutation.text, "source": digest(ROOT / mutant.path),
    }  # fmt: skip
    compiled = mutant.mutation.function in compiled_functions(mutant.path)
    spent, tried = 0.0, 0
    with tree.changed(mutant.path, mutant.mutation.planted(source), compiled) as code:
        functions = entered_functions(mutant, records)
        for name, files in zip(STAGES, mutant.stages, strict=True):
            order, seconds = chosen(functions, files, records, name)
            if not order:
                continue
            limit = 20 + 5 * seconds + (60 if compiled else 0)
            outcome = tree.run(Chooser(order), sorted({test.split("::")[0] for test in order}), limit, code)
            spent, tried = spent + outcome.seconds, tried + len(order)
            if outcome.failed or not outcome.in_time:
                by = outcome.failed or "time limit"
                return result | {"stage": name, "by": by, "seconds": round(spent, 1), "tests": deciding(by, mutant)}
    return result | {"stage": "", "by": "", "tried": tried, "seconds": round(spent, 1), "tests": deciding("", mutant)}


def entered_functions(mutant: Mutant, records: Records) -> frozenset[str]:
    """Those of a mutant; where no test is seen to enter them, as in a process of its own, all of its file."""
    seen = any(records.entering(file, mutant.functions) for files in mutant.stages for file in files)
    return mutant.functions if seen else functions_of(mutant.path)


def chosen(functions: frozenset[str], files: list[str], records: Records, stage: str) -> tuple[dict[str, int], float]:
    """The order of the tests to try: those that enter the functions, then, nearby, the others of the same files."""
    entering, others = dict[str, float](), dict[str, float]()
    for file in files:
        found = records.entering(file, functions)
        entering |= found
        if stage != STAGES[2] and (found or stage == STAGES[0]):
            others |= {t: s for t, s in records.seconds(file).items() if t not in found}
    limit = ELSEWHERE if stage == STAGES[2] else BESIDE
    order, seconds = dict[str, int](), 0.0
    for tests in (entering, others):
        for test in sorted(tests, key=lambda t: tests[t]):
            if seconds + tests[test] <= limit:
                seconds += tests[test]
                order[test] = len(order)
    return order, seconds


def deciding(by: str, mutant: Mutant) -> str:
    """A sum of the test file that killed a mutant, of all nearby ones where it survived."""
    files = [ROOT / f for f in test_files() if f in by] or [ROOT / f for stage in mutant.stages[:2] for f in stage]
    return digest(*files)


def try_all(mutants: list[Mutant], results: Results, jobs: int, seconds: float) -> None:
    """Record what tests enter where that is not known, then try one mutant after another."""
    load_libraries()
    records = Records(BUILD / "tests.json")
    for line in records.update(Tree(BUILD / "0")):
        print(line, flush=True)
    context = get_context("fork")
    number = context.Value("i", 0)
    with context.Pool(jobs, _begin, (records, number, time.monotonic() + seconds)) as pool:
        for count, entry in enumerate(filter(None, pool.imap_unordered(_try_one, mutants)), 1):
            results.add(entry)
            outcome = f"killed by {entry['by']}" if entry["by"] else "SURVIVED"
            place = f"{count}/{len(mutants)} {entry['seconds']:6.1f} s  {entry['path']}:{entry['line']}"
            print(f"{place}  {entry['mutation']}  {outcome}", flush=True)


def _begin(records: Records, number: Any, end: float) -> None:
    """In each worker: a tree of its own."""
    with number.get_lock():
        _worker.tree, _worker.records, _worker.end = Tree(BUILD / str(number.value)), records, end
        number.value += 1


def _try_one(mutant: Mutant) -> dict[str, Any] | None:
    return trial(mutant, _worker.tree, _worker.records) if time.monotonic() < _worker.end else None


_worker = SimpleNamespace()


class Results:
    """What is known of mutants, as lines of JSON."""

    def __init__(self, path: Path) -> None:
        self.path = path
        lines = path.read_text().splitlines() if path.exists() else []
        self.known: dict[str, dict[str, Any]] = {entry["key"]: entry for entry in map(json.loads, lines)}

    def holds(self, mutant: Mutant) -> bool:
        """Whether a mutant was tried and neither its source nor the tests that decided have changed since."""
        entry = self.known.get(mutant.key)
        if entry is None or entry["source"] != digest(ROOT / mutant.path):
            return False
        return bool(entry["tests"] == deciding(entry["by"], mutant))

    def add(self, entry: dict[str, Any]) -> None:
        """Keep how a trial went."""
        self.known[entry["key"]] = entry
        with self.path.open("a") as file:
            file.write(json.dumps(entry) + "\n")


# ---- the table --------------------------------------------------------------------------------------------------


def equivalents() -> dict[str, str]:
    """The reasons of the mutants that change nothing, by key."""
    return {entry["key"]: entry["reason"] for entry in tomllib.loads(EQUIVALENT.read_text())["mutant"]}


def table(mutants: list[Mutant], results: Results) -> Iterator[str]:
    """Killed and survived by folder, in Markdown, and the survivors."""
    reasons, rows, alive = equivalents(), defaultdict[str, Counter[str]](Counter), list[str]()
    for mutant in mutants:
        entry = results.known.get(mutant.key)
        if entry is None:
            continue
        outcome = entry["stage"] or ("equivalent" if mutant.key in reasons else "survived")
        for name in (mutant.area, "all"):
            rows[name].update(["mutants", outcome])
        if outcome == "survived":
            alive.append(f"- `{mutant.path}:{mutant.mutation.line}` {mutant.mutation.text} ({mutant.key})")
    heads = ("mutants", *STAGES, "survived", "equivalent")
    yield "| folder | mutants | killed by its own tests | by its folder | elsewhere | survived | equivalent | killed |"
    yield "|---" * (len(heads) + 2) + "|"
    for name in sorted(rows, key=lambda n: (n == "all", not n.startswith("orbiframe/"), n)):
        row = rows[name]
        killed = sum(row[stage] for stage in STAGES)
        share = f"{100 * killed / max(1, killed + row['survived']):.0f} %"
        yield f"| {name} | {' | '.join(str(row[head]) for head in heads)} | {share} |"
    yield from ["", "Still alive:", "", *sorted(alive)] if alive else ["", "None is alive."]


def main() -> None:
    """Draw mutants, try those that are not yet known, print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=240, help="mutants in all")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--folder", metavar="PREFIX", default="", help="only of folders whose name begins so")
    parser.add_argument("--seconds", type=float, default=math.inf, help="begin no trial after so many")
    parser.add_argument("--jobs", type=int, default=1, help="processes, each with a copy of the tree")
    parser.add_argument("--list", action="store_true", help="only show what is drawn")
    parser.add_argument("--table", action="store_true", help="only show the table of what is known")
    args = parser.parse_args()
    mutants = [m for m in drawn(args.seed, args.count) if m.area.startswith(args.folder)]
    results = Results(BUILD / "results.jsonl")
    if args.list:
        for mutant in mutants:
            print(f"{mutant.key} {mutant.path}:{mutant.mutation.line} {mutant.mutation.text}")
    elif not args.table:
        try_all([m for m in mutants if not results.holds(m)], results, args.jobs, args.seconds)
    if not args.list:
        print("\n".join(table(mutants, results)))


if __name__ == "__main__":
    main()
