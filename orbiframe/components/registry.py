"""Registry: names to components, imported on first use."""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Iterable
from importlib.metadata import EntryPoint
from pathlib import Path
from types import ModuleType
from typing import Any, TypeGuard, cast

import pluggy

from orbiframe import plugin as hooks
from orbiframe.components.chosen_entries import GROUP, chosen_entries
from orbiframe.components.geometry_names import geometry_name
from orbiframe.components.hooks import call_each, described, require_known_hooks
from orbiframe.components.plugin_file import imported_file
from orbiframe.components.shown_text import shown
from orbiframe.components.sound_component import sound
from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import PluginError, UsageError
from orbiframe.plugin import KINDS, Component

OWN = "orbiframe"
# Seconds after which the declarations of a plugin are called slow.
SLOW = 0.5

# The name of a plugin, and where it comes from: the name of a module, a file, or an object of its own.
Origin = tuple[str, object]


class Registry:
    """The components that plugins declare; an object that is passed down, never a global.

    A plugin that cannot be loaded is written into `broken`, as (name of the plugin, what went wrong), and stops nobody
    else; one whose declarations take long, into `slow`, as (name, seconds). Nothing that a component names is imported
    before `load`; `used` has the plugins, none of orbiframe's own, of what has been loaded. A name belongs to
    orbiframe's own component where it has one; that of another plugin is asked for as "plugin:name". A registry can be
    pickled: what arrives elsewhere has the same plugins, loaded there again, and the same plugin files, which must be
    there too.

    >>> from orbiframe import Registry
    >>> registry = Registry.discover()
    >>> [component.name for component in registry.components("geometry")]
    ['e2', 'h2', 's2']
    >>> h2 = registry.load("geometry", "h2")()
    >>> h2.curvature
    -1
    """

    def __init__(self) -> None:
        self.broken: list[tuple[str, str]] = []
        self.slow: list[tuple[str, float]] = []
        self.used: set[str] = set()
        self._own: set[str] = set()
        self._manager = pluggy.PluginManager(GROUP)
        self._manager.add_hookspecs(hooks)
        self._declared: list[tuple[Component, str]] = []
        self._origins: list[Origin] = []

    def __repr__(self) -> str:
        plugins = len({owner for _, owner in self._declared})
        return f"<Registry: {len(self._declared)} components of {plugins} plugins, {len(self.broken)} broken>"

    @classmethod
    def discover(cls, *, only: Iterable[str] | None = None, files: Iterable[Path] = ()) -> Registry:
        """The registry of all installed plugins (entry points of the group "orbiframe").

        only: names of the plugins to load; where it is None, the environment variable ORBIFRAME_PLUGINS=a,b says so.
        files: Python files that declare components like a plugin, loaded after the installed ones. Raises UsageError
        for a name in `only` that is not installed, PluginError for a file that cannot be loaded.
        """
        registry = cls()
        for entry in chosen_entries(only):
            registry._admit(entry)
        for path in files:
            registry.add_file(Path(path))
        return registry

    def register(self, name: str, declarations: object) -> None:
        """Add one plugin: a module or object with the hooks of `orbiframe.plugin`.

        Raises PluginError if it has no hook, or a declaration is wrong.
        """
        require_known_hooks(declarations, name, hooks)
        try:
            self._manager.register(declarations, name)
        except (ValueError, pluggy.PluginValidationError) as error:
            if self._manager.has_plugin(name) and self._manager.get_plugin(name) is declarations:
                self._manager.unregister(declarations)
            raise PluginError(f"plugin '{name}' cannot be registered: {error}") from error
        try:
            self._declared += [(component, name) for component in self._declarations_of(declarations, name)]
        except BaseException:
            self._manager.unregister(declarations)
            raise
        self._origins.append((name, declarations.__name__ if isinstance(declarations, ModuleType) else declarations))
        if getattr(declarations, "__name__", "").partition(".")[0] == OWN:
            self._own.add(name)

    def add_file(self, path: Path) -> None:
        """Add the plugin that one Python file declares, once. Raises PluginError where it cannot be loaded."""
        if self._manager.has_plugin(str(path)):
            return
        try:
            module = imported_file(path)
        except (Exception, SystemExit) as error:
            raise PluginError(f"the plugin file {path} cannot be loaded: {described(error)}") from error
        self.register(str(path), module)
        self._origins[-1] = str(path), path.absolute()

    def __reduce__(self) -> tuple[Callable[..., Registry], tuple[list[Origin], list[tuple[str, str]], list[str]]]:
        return _again, (self._origins, self.broken, sorted(self._own))

    # ---- asking ---------------------------------------------------------------------------------------------------

    def components(self, kind: str) -> list[Component]:
        """The components of one kind, sorted by name."""
        return sorted((c for c, _ in self._declared if c.kind == kind), key=lambda c: c.name)

    def declarations(self) -> list[tuple[Component, str]]:
        """Every component with the name of its plugin, sorted by kind (in the order of a fit) and name."""
        return sorted(self._declared, key=lambda pair: (KINDS.index(pair[0].kind), pair[0].name, pair[1]))

    def component(self, kind: str, name: str) -> Component:
        """The component of this name, or of "plugin:name" where several plugins declare the name.

        Raises UsageError if there is none, PluginError if two plugins declare it, neither of them orbiframe's own.
        """
        plugin, _, plain = name.rpartition(":")
        found = [
            (c, owner) for c, owner in self._declared if (c.kind, c.name) == (kind, plain) and plugin in ("", owner)
        ]
        found = [pair for pair in found if pair[1] in self._own] or found
        if not found:
            names = [c.name for c in self.components(kind)]
            installed = ", ".join(names) or "none"
            raise UsageError(
                f"no {kind} named '{shown(name, 100)}'; installed: {installed}.{did_you_mean(name, names)}"
            )
        if len(found) > 1:
            owners = " and ".join(f"'{owner}'" for _, owner in found)
            full = " or ".join(f"'{owner}:{name}'" for _, owner in found)
            raise PluginError(f"{kind} '{name}' is declared by the plugins {owners}; ask for {full}")
        return found[0][0]

    def for_suffix(self, kind: str, suffix: str) -> list[Component]:
        """The components of a kind for a file suffix: orbiframe's own where there are some, else all."""
        claims = [(c, owner) for c, owner in self._declared if c.kind == kind and suffix in c.suffixes]
        own = [pair for pair in claims if pair[1] in self._own]
        return sorted((c for c, _ in own or claims), key=lambda c: c.name)

    def hidden(self) -> list[tuple[Component, str]]:
        """The components, with their plugins, whose name belongs to orbiframe's own: to be had as "plugin:name"."""
        taken = {(c.kind, c.name) for c, owner in self._declared if owner in self._own}
        return [(c, o) for c, o in self._declared if o not in self._own and (c.kind, c.name) in taken]

    def stranger(self, module: str) -> str | None:
        """The plugin, none of orbiframe's own, to which a module belongs by its declarations or its targets."""
        root = _root(module)
        if root == OWN or root in {_root(c.target) for c, owner in self._declared if owner in self._own}:
            return None
        targets = {_root(c.target): owner for c, owner in self._declared if owner not in self._own}
        modules = {
            _root(getattr(plugin, "__name__", type(plugin).__module__)): name
            for name, plugin in self._manager.list_name_plugin()
            if name not in self._own
        }
        return (modules | targets).get(root)

    def load(self, kind: str, name: str) -> Callable[..., Any]:
        """What a component names, imported now.

        Raises UsageError for an unknown name; PluginError if the target cannot be imported, with the pip command
        where a package is missing.
        """
        component = self.component(kind, name)
        owner = self.owner(component)
        if owner not in self._own:
            self.used.add(owner)
        return resolve(component, self.title(component))

    def owner(self, component: Component) -> str:
        """The plugin that declares a component."""
        return next(owner for found, owner in self._declared if found is component)

    def title(self, component: Component) -> str:
        """How a component is called in sentences: with its plugin, unless that is one of orbiframe's own."""
        owner = self.owner(component)
        return f"{component.kind} '{component.name}'" + ("" if owner in self._own else f" of the plugin '{owner}'")

    def geometry(self, characteristic: float) -> Any:
        """The geometry, made now, of the closed surfaces with an Euler characteristic of this sign."""
        return self.load("geometry", geometry_name(characteristic))()

    def stage_done(self, stage: str, result: object, seconds: float) -> None:
        """Tell every plugin that listens (hook `orbiframe_stage_done`) that a stage of a fit has ended."""
        call_each(self._manager, "orbiframe_stage_done", stage=stage, result=result, seconds=seconds)

    def warm_up_commands(self) -> list[str]:
        """The commands, without `orbiframe` before them, that use all compiled code (hook `orbiframe_warm_up`)."""
        found = call_each(self._manager, "orbiframe_warm_up")
        return [line for lines in reversed(found) for line in cast("Iterable[str]", lines)]

    def shown(self, surface: object) -> object:
        """What notebooks show of a surface (hook `orbiframe_show`). Raises PluginError where no plugin shows any."""
        found = call_each(self._manager, "orbiframe_show")
        if not found:
            raise PluginError("no plugin shows surfaces; `surface.picture()` is a picture of it")
        return resolve(Component("show", "show", str(found[0]), ""), "the hook orbiframe_show")(surface)

    # ---- filling --------------------------------------------------------------------------------------------------

    def _admit(self, entry: EntryPoint) -> None:
        name, start = self._free_name(entry), time.perf_counter()
        own = entry.dist is not None and entry.dist.name == OWN
        try:
            self.register(name, entry.load())
        except (Exception, SystemExit) as error:
            self.broken.append((name, str(error) if isinstance(error, PluginError) else described(error)))
        if own:
            self._own.add(name)
        elif time.perf_counter() - start > SLOW:
            self.slow.append((name, time.perf_counter() - start))

    def _free_name(self, entry: EntryPoint) -> str:
        taken = self._manager.has_plugin(entry.name) and entry.dist is not None
        return f"{entry.dist.name}:{entry.name}" if taken and entry.dist else entry.name

    def _declarations_of(self, declarations: object, name: str) -> list[Component]:
        if not self._manager.get_hookcallers(declarations):
            raise PluginError(f"plugin '{name}' declares no hook; mark orbiframe_components with @hookimpl")
        found = call_each(self._manager, "orbiframe_components", only=declarations)
        return [sound(item, name) for items in found for item in cast("Iterable[object]", items)]


def _again(origins: list[Origin], broken: list[tuple[str, str]], own: list[str]) -> Registry:
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
    registry._own |= set(own)
    return registry


def resolve(component: Component, title: str = "") -> Callable[..., Any]:
    """The object that `component.target` names, imported now.

    title: what the component is called where that fails, which raises PluginError.
    """
    module, _, attribute = component.target.partition(":")
    title = title or f"{component.kind} '{component.name}'"
    try:
        found: Callable[..., Any] = getattr(importlib.import_module(module), attribute)
    except Exception as error:
        if isinstance(error, ModuleNotFoundError) and _is_foreign(error.name, module):
            hint = f'which is not installed: pip install "{component.extra or _root(error.name)}"'
            raise PluginError(f"{title} needs the package '{_root(error.name)}', {hint}") from error
        raise PluginError(f"{title} cannot be imported from '{component.target}': {described(error)}") from error
    if not callable(found):
        raise PluginError(f"{title}: the target '{component.target}' cannot be called; name a class or a function")
    return found


def _is_foreign(missing: str | None, module: str) -> TypeGuard[str]:
    """Whether a missing module is a package to install, not a part of the component's own package."""
    return bool(missing) and (missing == _root(module) or _root(str(missing)) != _root(module))


def _root(module: str) -> str:
    return module.partition(".")[0]
