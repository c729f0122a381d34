"""Hooks: those of a plugin are called one by one, so that whatever one raises is told with the plugin's name."""

from __future__ import annotations

import inspect
from collections.abc import Iterable
from types import ModuleType

import pluggy

from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import PluginError

_PREFIX = "orbiframe_"
# The hooks whose answer is a list.
_LISTS = ("orbiframe_components", "orbiframe_warm_up")


def call_each(manager: pluggy.PluginManager, hook: str, *, only: object = None, **arguments: object) -> list[object]:
    """What the plugins answer to a hook, the last registered first; `only`: this plugin alone.

    Raises PluginError, naming the plugin, for whatever a hook raises, and for an answer that is no list where one is
    needed.
    """
    calls = [call for call in getattr(manager.hook, hook).get_hookimpls() if only is None or call.plugin is only]
    return [_answer(call, hook, arguments) for call in reversed(calls)]


def _answer(call: pluggy.HookImpl, hook: str, arguments: dict[str, object]) -> object:
    title = f"plugin '{call.plugin_name}': its hook {hook}"
    try:
        answer = call.function(*(arguments[name] for name in call.argnames))
        return _listed(answer, title) if hook in _LISTS else answer
    except PluginError:
        raise
    except (Exception, SystemExit) as error:
        raise PluginError(f"{title} failed, {described(error)}; tell its author, or uninstall it") from error


def _listed(answer: object, title: str) -> list[object]:
    if not isinstance(answer, Iterable) or isinstance(answer, str):
        raise PluginError(f"{title} gives {answer!r}; it must return a list")
    return list(answer)


def require_known_hooks(declarations: object, name: str, known: ModuleType) -> None:
    """Raise PluginError for a hook that nobody calls: misspelt, or a function of that name that is not marked.

    known: the module with the specifications of all hooks.
    """
    hooks = [word for word in vars(known) if word.startswith(_PREFIX)]
    for word in dir(declarations):
        found = getattr(declarations, word, None)
        marked = hasattr(found, "orbiframe_impl") or hasattr(found, "orbiframe_spec")
        if marked and word not in hooks:
            raise PluginError(
                f"plugin '{name}' has a hook '{word}', which is never called; the hooks are {', '.join(hooks)}."
                f"{did_you_mean(word, hooks)}"
            )
        if word in hooks and not marked and (inspect.isfunction(found) or inspect.ismethod(found)):
            raise PluginError(f"plugin '{name}': {word} is not marked and never called; write @hookimpl above it")


def described(error: BaseException) -> str:
    """The kind of an error and its words."""
    return f"{type(error).__name__}: {error}"
