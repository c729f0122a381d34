"""Faults planted in plugins, one at a time: each is told with the name of the plugin, and stops nobody else."""

from __future__ import annotations

import sys
from textwrap import dedent
from typing import NamedTuple

import pytest

HEAD = """
import time
from orbiframe.plugin import Component, hookimpl
"""
TAIL = """
@hookimpl
def orbiframe_components():
    return [Component("{kind}", "{name}", "planted:{target}", "something that is wrong"{more})]
"""


class Fault(NamedTuple):
    """What is wrong in a plugin called "planted", the command that meets it, and what is said."""

    text: str
    command: str
    said: str
    status: int = 1
    kind: str = "basis"
    name: str = "wavy"
    target: str = "Wavy"
    more: str = ""
    declared: bool = True


FIT = "fit cube.off -o out.ply --size 40 --quiet"
BASIS = f"{FIT} --basis wavy"
COMMAND = {"kind": "command", "name": "greet", "target": "configure"}
READER = {"kind": "reader", "name": "wavy", "target": "read", "more": ", suffixes=('.wavy',)"}

FAULTS = {
    "a misspelt hook": Fault(
        "@hookimpl\ndef orbiframe_component(): return []",
        "plugins",
        "broken plugin 'planted': plugin 'planted' has a hook 'orbiframe_component', which is never called",
        0,
    ),
    "a hook without its mark": Fault(
        "def orbiframe_stage_done(stage): print(stage)",
        "plugins",
        "plugin 'planted': orbiframe_stage_done is not marked and never called; write @hookimpl above it",
        0,
    ),
    "a declaration that fails": Fault(
        "@hookimpl\ndef orbiframe_components(): return 1 / 0",
        "plugins",
        "plugin 'planted': its hook orbiframe_components failed, ZeroDivisionError",
        0,
        declared=False,
    ),
    "declarations that are no list": Fault(
        "@hookimpl\ndef orbiframe_components(): pass",
        "plugins",
        "plugin 'planted': its hook orbiframe_components gives None; it must return a list",
        0,
        declared=False,
    ),
    "a listener that fails": Fault(
        "@hookimpl\ndef orbiframe_stage_done(stage): raise KeyError(stage)",
        FIT,
        "plugin 'planted': its hook orbiframe_stage_done failed, KeyError: ",
    ),
    "a name with blanks": Fault(
        "", "plugins", "plugin 'planted': basis 'Bad Name!' has a name that", 0, name="Bad Name!"
    ),
    "a name that means none": Fault("", "plugins", "plugin 'planted': basis 'auto' has a name that", 0, name="auto"),
    "suffixes that are a text": Fault(
        "",
        "plugins",
        "plugin 'planted': reader 'wavy' has the suffixes '.wavy'",
        0,
        **{**READER, "more": ", suffixes='.wavy'"},
    ),
    "a taken name": Fault(
        "",
        "plugins",
        "taken name: basis 'gaussian' of the plugin 'planted' is had as 'planted:gaussian'",
        0,
        name="gaussian",
    ),
    "a slow start": Fault("time.sleep(0.6)", "--help", "the plugin 'planted' took 0.", 0),
    "a command without run": Fault(
        "def configure(parser): parser.add_argument('--loud', help='louder')",
        "plugins check greet",
        "FAILS  there_is_something_to_run",
        **COMMAND,
    ),
    "a command that cannot be configured": Fault(
        "def configure(parser): parser.no_such_thing()", "greet", "the plugin 'planted' failed (", **COMMAND
    ),
    "a command that fails": Fault(
        "def configure(parser): parser.set_defaults(run=run)\ndef run(args, registry): return {}['missing']",
        "greet",
        "the plugin 'planted' failed (",
        **COMMAND,
    ),
    "a command without a status": Fault(
        "def configure(parser): parser.set_defaults(run=lambda args, registry: 'fine')",
        "greet",
        "command 'greet' of the plugin 'planted' gives 'fine'",
        **COMMAND,
    ),
    "a basis that fails": Fault(
        "class Wavy:\n    def __init__(self, orbifold, triangulation, *, size=9): raise RuntimeError('no waves')",
        BASIS,
        "the plugin 'planted' failed (",
    ),
    "a basis that is none": Fault(
        "def Wavy(orbifold, triangulation, *, size=9): return 'waves'",
        BASIS,
        "basis 'wavy' of the plugin 'planted' gives a str, and must give a Basis",
    ),
    "a fitter of a wrong shape": Fault(
        "from orbiframe import Fitter\nclass Wavy(Fitter):\n    def fit(self, basis, samples): return samples.values",
        f"{FIT} --set fitter.name=wavy",
        "fitter 'wavy' of the plugin 'planted' gives float64 of shape ",
        kind="fitter",
    ),
    "a reader that fails": Fault(
        "def read(path): return path.no_such_thing",
        "info mesh.wavy",
        "(in the plugin 'planted', ",
        **READER,
    ),
    "a package that is not there": Fault(
        "def __getattr__(name): raise ModuleNotFoundError('no', name='wavelets')",
        BASIS,
        "basis 'wavy' of the plugin 'planted' needs the package 'wavelets'",
    ),
}


@pytest.fixture
def plant(tmp_path, monkeypatch, cube):
    """Install a plugin with a fault, in a folder with meshes."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "mesh.wavy").write_text("waves")
    installed = []

    def install(fault: Fault, module: str = "planted") -> None:
        tail = TAIL.format(kind=fault.kind, name=fault.name, target=fault.target, more=fault.more)
        (tmp_path / f"{module}.py").write_text(HEAD + dedent(fault.text) + (tail if fault.declared else ""))
        info = tmp_path / f"{module}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[orbiframe]\n{module} = {module}\n")
        installed.append(module)

    yield install
    for module in installed:
        sys.modules.pop(module, None)


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_told_with_the_plugin(plant, orbiframe, name):
    fault = FAULTS[name]
    plant(fault)
    ran = orbiframe(*fault.command.split())
    assert fault.said in ran.out + ran.err
    assert "'planted'" in ran.out + ran.err
    assert ran.status == fault.status, ran


def test_the_default_fit_goes_on(plant, orbiframe):
    """With a dozen plugins that are broken, badly named or of a taken name beside it."""
    names = [name for name, fault in FAULTS.items() if fault.command == "plugins"]
    for number, name in enumerate(names):
        plant(FAULTS[name], f"planted_{number}")
    plant(FAULTS["a taken name"], "of_a_taken_name")
    plant(
        Fault("", "", "", kind="reader", name="mine", target="read", more=", suffixes=('.off',)"), "of_a_taken_suffix"
    )
    assert orbiframe(*FIT.split(), "--fast").status == 0
