"""The laws of a picture of groups: a file appears, and it depends on the group alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from orbiframe.errors import OrbiframeError
from orbiframe.groups.group import Group
from orbiframe.testing.lab import Lab

Component = Callable[[Path, Group], Any]


def file_appears(component: Component, lab: Lab) -> None:
    """Every group, of any geometry, orientable or not, becomes a file of the name that was asked for."""
    for name, group in lab.groups.items():
        path = _drawn(component, lab, name, group)
        assert path.is_file(), f"no file {path.name} is made"
        assert path.stat().st_size > 0, f"{path.name} is empty"


def same_bytes(component: Component, lab: Lab) -> None:
    """The same group drawn twice, under another name, gives the same bytes."""
    for name, group in lab.groups.items():
        first, second = (_drawn(component, lab, f"{name} {k}", group).read_bytes() for k in (1, 2))
        assert first == second, f"the bytes of the picture of the {name} depend on more than the group"


def groups_differ(component: Component, lab: Lab) -> None:
    """Different groups give different pictures."""
    files = {_drawn(component, lab, name, group).read_bytes() for name, group in lab.groups.items()}
    assert len(files) == len(lab.groups), "different groups give the same bytes"


def missing_folder_is_refused(component: Component, lab: Lab) -> None:
    """In a folder that is not there nothing is made, and an error of ours says so."""
    path = lab.tmp_path / "nowhere" / f"group{lab.suffix}"
    try:
        component(path, next(iter(lab.groups.values())))
    except OrbiframeError:
        assert not path.parent.exists(), "a folder is made that was not asked for"
        return
    raise AssertionError("a missing folder is accepted")


def _drawn(component: Component, lab: Lab, name: str, group: Group) -> Path:
    path = lab.tmp_path / f"{name}{lab.suffix}"
    component(path, group)
    return path


LAWS = (file_appears, same_bytes, groups_differ, missing_folder_is_refused)


def _forgets_some(component: Component) -> Component:
    def forgetful(path: Path, group: Group) -> None:
        if group.word.orientable:
            component(path, group)

    return forgetful


def _signs_with_its_name(component: Component) -> Component:
    def signed(path: Path, group: Group) -> None:
        component(path, group)
        path.write_bytes(path.read_bytes() + path.name.encode())

    return signed


def _draws_one(component: Component) -> Component:
    drawn: list[Group] = []

    def always(path: Path, group: Group) -> None:
        drawn.append(group)
        component(path, drawn[0])

    return always


def _makes_folders(component: Component) -> Component:
    def helpful(path: Path, group: Group) -> None:
        path.parent.mkdir(exist_ok=True)
        component(path, group)

    return helpful


MUTANTS: Mapping[str, Callable[[Component], Component]] = {
    "file_appears": _forgets_some,
    "same_bytes": _signs_with_its_name,
    "groups_differ": _draws_one,
    "missing_folder_is_refused": _makes_folders,
}
