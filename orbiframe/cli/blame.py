"""Blame: which plugin an unexpected error comes from."""

from __future__ import annotations

from collections.abc import Iterator

from orbiframe.components.hooks import described
from orbiframe.components.registry import Registry
from orbiframe.errors import OrbiframeError, PluginError


def named(error: Exception, registry: Registry) -> Exception:
    """The error, or a PluginError that names the plugin in whose code it was raised, with the place.

    An error that is a sentence for the user stays what it is, but for the name of the plugin where another error is
    its cause. What is raised in orbiframe's own code, while components of plugins took part, names these.
    """
    if isinstance(error, OrbiframeError):
        return _with_plugin(error, registry)
    if isinstance(error, OSError | MemoryError):
        return error
    found = _place(error, registry)
    if found is not None:
        plugin, place = found
        return PluginError(
            f"the plugin '{plugin}' failed ({place}), {described(error)}; tell its author what --debug shows, or leave "
            "it out"
        )
    if registry.used:
        plugins = ", ".join(f"'{name}'" for name in sorted(registry.used))
        return PluginError(
            f"internal error while the plugin {plugins} took part, {described(error)}; try `orbiframe plugins check` "
            "on its components, and --debug for the traceback"
        )
    return error


def _with_plugin(error: OrbiframeError, registry: Registry) -> Exception:
    cause = error.__cause__
    if cause is None or isinstance(cause, OrbiframeError | OSError | MemoryError):
        return error
    found = _place(cause, registry)
    if found is None or f"'{found[0]}'" in str(error):
        return error
    plugin, place = found
    return type(error)(f"{error} (in the plugin '{plugin}', {place})")


def _place(error: BaseException, registry: Registry) -> tuple[str, str] | None:
    """The plugin whose code is innermost in the traceback of an error, and the file and line there."""
    found = None
    for module, place in _frames(error):
        plugin = registry.stranger(module)
        found = found if plugin is None else (plugin, place)
    return found


def _frames(error: BaseException) -> Iterator[tuple[str, str]]:
    """The module and the place of every frame, from the outermost on."""
    trace = error.__traceback__
    while trace is not None:
        frame = trace.tb_frame
        yield str(frame.f_globals.get("__name__", "")), f"{frame.f_code.co_filename}, line {trace.tb_lineno}"
        trace = trace.tb_next
