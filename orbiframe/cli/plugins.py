"""orbiframe plugins: the installed components, and whether one keeps the laws of its kind."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import asdict

from orbiframe.components.registry import Registry, resolve
from orbiframe.errors import PluginError, UsageError
from orbiframe.plugin import KINDS, Component


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--kind", choices=KINDS, help="only components of this kind")
    parser.add_argument("--options", action="store_true", help="show the options of each component as well")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)
    actions = parser.add_subparsers(metavar="check", title="checking a component")
    check = actions.add_parser("check", help="try a component on the laws of its kind")
    check.add_argument("name", metavar="NAME", help="name of a component, or KIND/NAME")
    check.set_defaults(run=run_check)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """List the components and the plugins that could not be loaded."""
    shown = [pair for pair in registry.declarations() if args.kind in (None, pair[0].kind)]
    if args.json:
        print(json.dumps(_data(shown, registry, args.options), indent=2, default=str))
        return 0
    for line in _table(shown, args.options):
        print(line)
    for plugin, error in registry.broken:
        print(f"broken plugin '{plugin}': {error}")
    return 0


def run_check(args: argparse.Namespace, registry: Registry) -> int:
    """Try a component on its laws; the status is 1 if one does not hold."""
    from orbiframe.testing.check import check
    from orbiframe.testing.kit import has_laws

    component = find(args.name, registry)
    found = check(component, registry)
    for verdict in found:
        print(f"{'holds' if verdict.error is None else 'FAILS'}  {verdict.law}: {verdict.error or verdict.statement}")
    held = sum(verdict.error is None for verdict in found)
    print(f"{component.kind} '{component.name}': {held} of {len(found)} laws held")
    if not has_laws(component.kind):
        print(f"beyond these, there are no laws for the kind '{component.kind}'")
    return 0 if held == len(found) else 1


def find(text: str, registry: Registry) -> Component:
    """The component of a name "gaussian" or "basis/gaussian". Raises UsageError for none or several."""
    kind, slash, name = text.rpartition("/")
    if slash:
        return registry.component(kind, name)
    kinds = sorted({c.kind for c, _ in registry.declarations() if c.name == name})
    if len(kinds) == 1:
        return registry.component(kinds[0], name)
    if kinds:
        raise UsageError(
            f"'{name}' is the name of several components; say " + " or ".join(f"{k}/{name}" for k in kinds)
        )
    raise UsageError(f"no component named '{name}'; `orbiframe plugins` lists them")


def _table(shown: list[tuple[Component, str]], options: bool) -> Iterator[str]:
    rows = [(c.kind, c.name, plugin, c.summary) for c, plugin in shown]
    widths = [max((len(row[i]) for row in rows), default=0) + 2 for i in range(3)]
    for row, (component, _) in zip(rows, shown, strict=True):
        yield "".join(entry.ljust(width) for entry, width in zip(row, [*widths, 0], strict=True))
        if options:
            yield from _option_lines(component)


def _option_lines(component: Component) -> Iterator[str]:
    from orbiframe.components.options import options_of

    try:
        target = resolve(component)
    except PluginError as error:
        yield f"    {error}"
        return
    yield f"    {(target.__doc__ or '').strip().partition(chr(10))[0]}"
    for option in options_of(target):
        value = "required" if option.required else repr(option.default)
        yield f"    {option.name}: {option.type_name} = {value}"


def _data(shown: list[tuple[Component, str]], registry: Registry, options: bool) -> dict[str, object]:
    components = [
        {**asdict(c), "plugin": plugin, **({"options": _option_data(c)} if options else {})} for c, plugin in shown
    ]
    broken = [{"plugin": plugin, "error": error} for plugin, error in registry.broken]
    return {"components": components, "broken": broken}


def _option_data(component: Component) -> list[dict[str, object]]:
    from orbiframe.components.options import options_of

    return [
        {"name": o.name, "type": o.type_name, "required": o.required, "default": None if o.required else o.default}
        for o in options_of(resolve(component))
    ]
