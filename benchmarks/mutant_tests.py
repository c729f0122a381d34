"""Which tests to try on a mutant: those beside its module first, then others that enter the changed function.

What every test enters is recorded once for each test file, in a process of its own.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
import sys
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import pytest
from mutant_trials import ROOT, SOURCES, Tree

_RECORDING_LIMIT = 900.0
LEFT_OUT = (
    "tests/docs/",
    "tests/architecture/",
    "tests/out_of_tree/",
    "tests/accuracy/",
    "tests/corpus/",
    "tests/benchmarks/",
)


class Recorder:
    """A plugin of pytest that records, for a file of tests, the seconds of each and the functions it enters."""

    options = ()

    def __init__(self, root: Path) -> None:
        self.root, self.failed, self.send = f"{root}/", "", sys.stdout
        self.entries: dict[str, Any] = {"collected": [], "tests": {}, "failing": []}
        self._names: dict[int, tuple[Any, str]] = {}
        self._entered: set[str] = set()

    def received(self, entry: dict[str, Any]) -> None:
        """In the parent: keep what the child has sent."""
        if "failed" in entry:
            self.failed = self.failed or entry["failed"]
            self.entries["failing"].append(entry["failed"])
        elif entry["test"]:
            self.entries["tests"][entry["test"]] = [entry["seconds"], entry["entered"]]
        else:
            self.entries["collected"] = entry["entered"]

    def _trace(self, frame: Any, *_: object) -> None:
        code = frame.f_code
        if id(code) not in self._names:
            here = code.co_filename.startswith(self.root)
            place = code.co_filename.removeprefix(self.root)
            self._names[id(code)] = code, f"{place}:{plain(code.co_qualname)}" if here else ""
        name = self._names[id(code)][1]
        if name.startswith(SOURCES):
            self._entered.add(name)

    @contextmanager
    def _recorded(self, test: str) -> Iterator[None]:
        import numba.core.event as events

        self._entered, timer, start = set(), events.TimingListener(), _processor_seconds()
        before = sys.gettrace()
        sys.settrace(self._trace)
        with events.install_listener("numba:compile", timer):
            yield
        sys.settrace(before)
        compiling = timer.duration if timer.done else 0.0
        seconds = _processor_seconds() - start - compiling
        entry = {"test": test, "seconds": round(max(seconds, 0.0), 3), "entered": sorted(self._entered)}
        self.send.write(json.dumps(entry) + "\n")

    @pytest.hookimpl(wrapper=True)
    def pytest_make_collect_report(self, collector: Any) -> Generator[None, Any, Any]:
        """While a file is imported."""
        with self._recorded("") if isinstance(collector, pytest.Module) else nullcontext():
            return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: Any) -> Generator[None, Any, Any]:
        """While a test runs."""
        with self._recorded(item.nodeid):
            return (yield)

    def pytest_runtest_logreport(self, report: Any) -> None:
        """A test that fails without a mutant."""
        if report.failed:
            self.send.write(json.dumps({"failed": report.nodeid}) + "\n")


class Chooser:
    """A plugin of pytest that runs the chosen tests of some files in a given order and reports the first that fails."""

    options = ("-x",)

    def __init__(self, order: dict[str, int]) -> None:
        self.order, self.failed, self.send = order, "", sys.stdout

    def received(self, entry: dict[str, str]) -> None:
        """In the parent: keep the first failure."""
        self.failed = self.failed or entry["failed"]

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        """Only the chosen tests, the quickest first."""
        chosen = [item for item in items if item.nodeid in self.order]
        items[:] = sorted(chosen, key=lambda item: self.order[item.nodeid])

    def pytest_runtest_logreport(self, report: Any) -> None:
        """A test, its preparation or its end has failed."""
        if report.failed:
            self.send.write(json.dumps({"failed": report.nodeid}) + "\n")

    def pytest_collectreport(self, report: Any) -> None:
        """A file cannot be imported."""
        if report.failed:
            self.send.write(json.dumps({"failed": f"import of {report.nodeid}"}) + "\n")


def _processor_seconds() -> float:
    """Of this process and of those that it has started and waited for."""
    return sum(os.times()[:4])


def plain(name: str) -> str:
    """The qualified name of a function without the marks of inner scopes."""
    return ".".join(part for part in name.split(".") if not part.startswith("<"))


@dataclass(frozen=True)
class Records:
    """What the tests of every file enter, kept on disk with a sum of the file."""

    path: Path

    @cached_property
    def files(self) -> dict[str, dict[str, Any]]:
        """For each test file its sum, what is entered when it is imported, and its tests."""
        return json.loads(self.path.read_text()) if self.path.exists() else {}

    def update(self, tree: Tree) -> Iterator[str]:
        """Record all test files that are new or changed; yields a line for each."""
        for file in test_files():
            total = digest(ROOT / file)
            if self.files.get(file, {}).get("sum") == total:
                continue
            recorder = Recorder(tree.root)
            outcome = tree.run(recorder, [file], _RECORDING_LIMIT)
            self.files[file] = {"sum": total, **recorder.entries}
            self.path.write_text(json.dumps(self.files))
            yield f"{outcome.seconds:7.1f} s  {file}  {outcome.failed and 'FAILS: ' + outcome.failed}"

    def entering(self, file: str, functions: frozenset[str]) -> dict[str, float]:
        """The tests of a file that enter one of the functions, with their seconds; all if its import does."""
        everything = not functions.isdisjoint(self.files[file]["collected"])
        tests = self._passing(file)
        return {t: s for t, (s, entered) in tests.items() if everything or not functions.isdisjoint(entered)}

    def seconds(self, file: str) -> dict[str, float]:
        """The seconds of every test of a file."""
        return {test: s for test, (s, _) in self._passing(file).items()}

    def _passing(self, file: str) -> dict[str, Any]:
        """The tests of a file that do not fail as it is, without a mutant."""
        record = self.files[file]
        return {test: entry for test, entry in record["tests"].items() if test not in record["failing"]}


@cache
def test_files() -> tuple[str, ...]:
    """All files of tests, but for those that look at texts alone and the long ones."""
    found = sorted(str(p.relative_to(ROOT)) for p in (ROOT / "tests").rglob("test_*.py"))
    return tuple(file for file in found if not file.startswith(LEFT_OUT))


def digest(*files: Path) -> str:
    """A sum of the contents of files."""
    total = hashlib.sha256()
    for file in files:
        total.update(file.read_bytes())
    return total.hexdigest()[:16]


# ---- who calls compiled code ------------------------------------------------------------------------------------


@cache
def imports() -> dict[str, frozenset[str]]:
    """For each source the sources that it imports from; a facade stands for the files that it lists."""
    return {path: frozenset(_imported(path)) for path in sources()}


@cache
def sources() -> tuple[str, ...]:
    """All Python sources under trial."""
    return tuple(sorted(str(p.relative_to(ROOT)) for folder in SOURCES for p in (ROOT / folder).rglob("*.py")))


def _imported(path: str) -> Iterator[str]:
    for node in ast.walk(ast.parse((ROOT / path).read_bytes())):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield from _files_of(node.module, tuple(alias.name for alias in node.names))


def _files_of(module: str, names: Sequence[str]) -> Iterator[str]:
    parts = module.replace(".", "/")
    for place in (parts, f"plugins/{parts}", *(f"{folder}{parts}/{n}" for n in names for folder in ("", "plugins/"))):
        if (ROOT / f"{place}.py").exists():
            yield f"{place}.py"
    facade = ROOT / parts / "__init__.pyi"
    if facade.exists():
        for node in ast.walk(ast.parse(facade.read_bytes())):
            if isinstance(node, ast.ImportFrom) and node.module and any(a.name in names for a in node.names):
                yield from _files_of(f"{module}.{node.module}" if node.level else node.module, ())


@cache
def compiled_functions(path: str) -> frozenset[str]:
    """The names of the compiled functions of a source; "" for its constants, which are compiled into them."""
    tree = ast.parse((ROOT / path).read_bytes())
    found = [f for f in ast.walk(tree) if isinstance(f, ast.FunctionDef)]
    marked = {f.name for f in found if any(ast.unparse(d).startswith("compiled") for d in f.decorator_list)}
    return frozenset(marked | {""}) if marked else frozenset()


@cache
def with_callers(path: str) -> frozenset[str]:
    """A source and those with compiled functions that import it, directly or through others."""
    found = {path}
    while True:
        more = {p for p in sources() if p not in found and compiled_functions(p) and not found.isdisjoint(imports()[p])}
        if not more:
            return frozenset(found)
        found |= more


@cache
def functions_near(path: str) -> frozenset[str]:
    """Functions whose run may run compiled code of a source: all of the files that import it or its callers."""
    compiled = with_callers(path)
    near = compiled | {p for p in sources() if not compiled.isdisjoint(imports()[p])}
    return frozenset(name for p in near for name in functions_of(p))


@cache
def functions_of(path: str) -> frozenset[str]:
    """The names of all functions of a source, as they are recorded."""
    found: set[str] = set()

    def visit(node: ast.AST, names: tuple[str, ...]) -> None:
        for child in ast.iter_child_nodes(node):
            named = isinstance(child, ast.FunctionDef | ast.ClassDef)
            inner = (*names, child.name) if named else names
            if isinstance(child, ast.FunctionDef):
                found.add(f"{path}:{'.'.join(inner)}")
            visit(child, inner)

    visit(ast.parse((ROOT / path).read_bytes()), ())
    return frozenset(found)
