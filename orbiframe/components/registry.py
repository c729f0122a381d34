"""Registry: names to components, imported on first use."""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Iterable
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any, TypeGuard, cast

import pluggy

from orbiframe import plugin as hooks
from orbiframe.components.geometry_names import geometry_name
from orbiframe.components.plugin_file import imported_file
from orbiframe.components.shown_text import shown
from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import PluginError, UsageError
from orbiframe.plugin import KINDS, Component

GROUP = "orbiframe"
RESTRICTION = "ORBIFRAME_PLUGINS"

# The name of a plugin, and where it comes from: the name of a module, a file, or an object of its own.
Origin = tuple[str, object]


class Registry:
    """The components that plugins declare; an object that is passed down, never a global.

    A plugin that cannot be loaded is written into `broken`, as (name of the plugin, what went wrong), and stops nobody
    else. Nothing that a component names is imported before `load`. A registry can be pickled: what arrives elsewhere
    has the same plugins, loaded there again, and the same plugin files, which must be there too.
    """

    def __init__(self) -> None:
        self.broken: list[tuple[str, str]] = []
        self._manager = pluggy.PluginManager(GROUP)
        self._manager.add_hookspecs(hooks)
        self._declared: list[tuple[Component, str]] = []
        self._origins: list[Origin] = []

    @classmethod
    def discover(cls, *, only: Iterable[str] | None = None, files: Iterable[Path] = ()) -> Registry:
        """The registry of all installed plugins (entry points of the group "orbiframe").

        only: names of the plugins to load; where it is None, the environment variable ORBIFRAME_PLUGINS=a,b says so.
        files: Python files that declare components like a plugin, loaded after the installed ones. Raises UsageError
        for a name in `only` that is not installed, PluginError for a file that cannot be loaded.
        """
        registry = cls()
        for entry in _chosen(sorted(entry_points(group=GROUP)), only):
            registry._admit(registry._free_name(entry), entry)
        for path in files:
            registry.add_file(Path(path))
        return registry

    def register(self, name: str, declarations: object) -> None:
        """Add one plugin: a module or object with the hooks of `orbiframe.plugin`.

        Raises PluginError if it has no hook, or a declaration is wrong.
        """
        try:
            self._manager.register(declarations, name)
        except (ValueError, pluggy.PluginValidationError) as error:
            raise PluginError(f"plugin '{name}' cannot be registered: {error}") from error
        try:
            self._declared += [(component, name) for component in self._declarations_of(declarations, name)]
        except BaseException:
            self._manager.unregister(declarations)
            raise
        self._origins.append((name, declarations.__name__ if isinstance(declarations, ModuleType) else declarations))

    def add_file(self, path: Path) -> None:
        """Add the plugin that one Python file declares, once. Raises PluginError where it cannot be loaded."""
        if self._manager.has_plugin(str(path)):
            return
        try:
            module = imported_file(path)
        except (Exception, SystemExit) as error:
            raise PluginError(f"the plugin file {path} cannot be loaded: {_described(error)}") from error
        self.register(str(path), module)
        self._origins[-1] = str(path), path.absolute()

    def __reduce__(self) -> tuple[Callable[..., Registry], tuple[list[Origin], list[tuple[str, str]]]]:
        return _again, (self._origins, self.broken)

    # ---- asking ---------------------------------------------------------------------------------------------------

    def components(self, kind: str) -> list[Component]:
        """The components of one kind, sorted by name."""
        return sorted((c for c, _ in self._declared if c.kind == kind), key=lambda c: c.name)

    def declarations(self) -> list[tuple[Component, str]]:
        """Every component with the name of its plugin, sorted by kind (in the order of a fit) and name."""
        return sorted(self._declared, key=lambda pair: (KINDS.index(pair[0].kind), pair[0].name, pair[1]))

    def component(self, kind: str, name: str) -> Component:
        """The component of this name. Raises UsageError if there is none, PluginError if two plugins declare it."""
        found = [(c, owner) for c, owner in self._declared if (c.kind, c.name) == (kind, name)]
        if not found:
            names = [c.name for c in self.components(kind)]
            installed = ", ".join(names) or "none"
            raise UsageError(
                f"no {kind} named '{shown(name, 100)}'; installed: {installed}.{did_you_mean(name, names)}"
            )
        if len(found) > 1:
            owners = " and ".join(f"'{owner}'" for _, owner in found)
            raise PluginError(f"{kind} '{name}' is declared by the plugins {owners}; {_restrict_hint()}")
        return found[0][0]

    def load(self, kind: str, name: str) -> Callable[..., Any]:
        """What a component names, imported now.

        Raises UsageError for an unknown name; PluginError if the target cannot be imported, with the pip command
        where a package is missing.
        """
        return resolve(self.component(kind, name))

    def geometry(self, characteristic: float) -> Any:
        """The geometry, made now, of the closed surfaces with an Euler characteristic of this sign."""
        return self.load("geometry", geometry_name(characteristic))()

    def stage_done(self, stage: str, result: object, seconds: float) -> None:
        """Tell every plugin that listens (hook `orbiframe_stage_done`) that a stage of a fit has ended."""
        self._manager.hook.orbiframe_stage_done(stage=stage, result=result, seconds=seconds)

    def warm_up_commands(self) -> list[str]:
        """The commands, without `orbiframe` before them, that use all compiled code (hook `orbiframe_warm_up`)."""
        return [line for lines in reversed(self._manager.hook.orbiframe_warm_up()) for line in lines]

    # ---- filling --------------------------------------------------------------------------------------------------

    def _admit(self, name: str, entry: EntryPoint) -> None:
        try:
            self.register(name, entry.load())
        except (Exception, SystemExit) as error:
            self.broken.append((name, str(error) if isinstance(error, PluginError) else _described(error)))

    def _free_name(self, entry: EntryPoint) -> str:
        taken = self._manager.has_plugin(entry.name) and entry.dist is not None
        return f"{entry.dist.name}:{entry.name}" if taken and entry.dist else entry.name

    def _declarations_of(self, declarations: object, name: str) -> list[Component]:
        if not self._manager.get_hookcallers(declarations):
            raise PluginError(f"plugin '{name}' declares no hook; mark orbiframe_components with @hookimpl")
        hook = self._manager.hook.orbiframe_components
        calls = [call for call in hook.get_hookimpls() if call.plugin is declarations]
        return [_checked(item, name) for call in calls for item in cast("Iterable[object]", call.function())]


def _again(origins: list[Origin], broken: list[tuple[str, str]]) -> Registry:
    """The registry of these plugins, loaded in this process."""
    registry = Registry()
    for name, origin in origins:
        if isinstance(origin, Path):
            module: object = imported_file(origin)
        else:
            module = importlib.import_module(origin) if isinstance(origin, str) else origin
        registry.register(name, module)
        registry._origins[-1] = name, origin
    registry.broken += broken
    return registry


def resolve(component: Component) -> Callable[..., Any]:
    """The object that `component.target` names, imported now. Raises PluginError where that fails."""
    module, _, attribute = component.target.partition(":")
    title = f"{component.kind} '{component.name}'"
    try:
        found: Callable[..., Any] = getattr(importlib.import_module(module), attribute)
    except Exception as error:
        if isinstance(error, ModuleNotFoundError) and _is_foreign(error.name, module):
            hint = f'which is not installed: pip install "{component.extra or _root(error.name)}"'
            raise PluginError(f"{title} needs the package '{_root(error.name)}', {hint}") from error
        raise PluginError(f"{title} cannot be imported from '{component.target}': {_described(error)}") from error
    if not callable(found):
        raise PluginError(f"{title}: the target '{component.target}' cannot be called; name a class or a function")
    return found


def _is_foreign(missing: str | None, module: str) -> TypeGuard[str]:
    """Whether a missing module is a package to install, not a part of the component's own package."""
    return bool(missing) and (missing == _root(module) or _root(str(missing)) != _root(module))


def _root(module: str) -> str:
    return module.partition(".")[0]


def _chosen(entries: list[EntryPoint], only: Iterable[str] | None) -> list[EntryPoint]:
    wanted = _restriction() if only is None else list(only)
    if wanted is None:
        return entries
    names = sorted({entry.name for entry in entries})
    for name in wanted:
        if name not in names:
            raise UsageError(
                f"no plugin named '{name}' (asked for by {RESTRICTION} or `only`); "
                f"installed: {', '.join(names) or 'none'}.{did_you_mean(name, names)}"
            )
    return [entry for entry in entries if entry.name in wanted]


def _restriction() -> list[str] | None:
    text = os.environ.get(RESTRICTION)
    return None if text is None else [name.strip() for name in text.split(",") if name.strip()]


def _restrict_hint() -> str:
    return f"uninstall one of them, or leave one out of {RESTRICTION}=plugin,plugin,…"


def _checked(component: object, owner: str) -> Component:
    if not isinstance(component, Component):
        raise PluginError(f"plugin '{owner}' declares {component!r}; orbiframe_components must return Components")
    title = f"plugin '{owner}': {component.kind} '{component.name}'"
    if component.kind not in KINDS:
        raise PluginError(f"{title} is of an unknown kind; the kinds are {', '.join(KINDS)}")
    module, colon, attribute = component.target.partition(":")
    if not (module and colon and attribute):
        raise PluginError(f"{title} has the target '{component.target}'; write 'package.module:object'")
    return component


def _described(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}"
