"""orbiframe plugins: the installed components, and whether one keeps the laws of its kind."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from orbiframe.components.registry import Registry, resolve
from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import PluginError, UsageError
from orbiframe.plugin import KINDS, Component

if TYPE_CHECKING:
    from orbiframe.testing.kit import Verdict


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--kind", choices=KINDS, help="only components of this kind")
    parser.add_argument("--options", action="store_true", help="show the options of each component as well")
    parser.add_argument("--json", action="store_true", help="print JSON")
    _add_config(parser, None)
    parser.set_defaults(run=run)
    actions = parser.add_subparsers(metavar="check", title="checking a component")
    check = actions.add_parser("check", help="try a component on the laws of its kind")
    check.add_argument("name", metavar="NAME", help="name of a component, or KIND/NAME")
    _add_config(check, argparse.SUPPRESS)
    check.set_defaults(run=run_check)


def _add_config(parser: argparse.ArgumentParser, default: object) -> None:
    text = "a configuration, whose plugin files are there as well"
    parser.add_argument("--config", metavar="FILE.toml", type=Path, default=default, help=text)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """List the components, and the plugins that are broken or slow or whose names are taken."""
    _add_files(args.config, registry)
    shown = [pair for pair in registry.declarations() if args.kind in (None, pair[0].kind)]
    if args.json:
        print(json.dumps(_data(shown, registry, args.options), indent=2, default=str))
        return 0
    for line in _table(shown, args.options):
        print(line)
    for plugin, error in registry.broken:
        print(f"broken plugin '{plugin}': {error}")
    for component, plugin in registry.hidden():
        print(
            f"taken name: {component.kind} '{component.name}' of the plugin '{plugin}' is had as "
            f"'{plugin}:{component.name}'"
        )
    return 0


def _add_files(config: Path | None, registry: Registry) -> None:
    """Load the plugin files that a configuration names."""
    if config is None:
        return
    from orbiframe.fitting.config import Config

    for path in Config.parsed(config).plugins:
        registry.add_file(path)


def run_check(args: argparse.Namespace, registry: Registry) -> int:
    """Try a component on its laws; the status is 1 if one does not hold."""
    from orbiframe.testing.check import check

    _add_files(args.config, registry)
    component = find(args.name, registry)
    found = check(component, registry)
    for verdict in found:
        print(_line(verdict))
    failed = sum(verdict.error is not None for verdict in found)
    untried = sum(verdict.untried is not None for verdict in found)
    count = len(found) - untried
    plugin = registry.owner(component)
    rest = f", {untried} could not be tried" if untried else ""
    print(f"{component.kind} '{component.name}' of the plugin '{plugin}': {count - failed} of {count} laws held{rest}")
    return 1 if failed else 0


def _line(verdict: Verdict) -> str:
    """What a law says, in one line."""
    word = "FAILS" if verdict.error else "-----" if verdict.untried else "holds"
    return f"{word}  {verdict.law}: {verdict.error or verdict.untried or verdict.statement}"


def find(text: str, registry: Registry) -> Component:
    """The component of a name "gaussian" or "basis/gaussian". Raises UsageError for none or several."""
    kind, slash, name = text.partition("/")
    kind, name = (kind, name) if slash else ("", text)
    if slash:
        return registry.component(kind, name)
    plugin, _, plain = name.rpartition(":")
    kinds = sorted({c.kind for c, o in registry.declarations() if c.name == plain and plugin in ("", o)})
    if len(kinds) == 1:
        return registry.component(kinds[0], name)
    if kinds:
        raise UsageError(
            f"'{name}' is the name of several components; say " + " or ".join(f"{k}/{name}" for k in kinds)
        )
    names = [c.name for c, _ in registry.declarations()]
    raise UsageError(f"no component named '{name}'; `orbiframe plugins` lists them.{did_you_mean(name, names)}")


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
