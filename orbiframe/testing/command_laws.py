"""The laws of a command: it can be asked for help, and there is something to run."""

from __future__ import annotations

import argparse
import inspect
from collections.abc import Callable, Iterator, Mapping
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from typing import Any

from orbiframe.testing.lab import Lab

Component = Callable[[argparse.ArgumentParser], Any]

# The options that every command has.
_COMMON = ("--help", "--debug", "--progress")
# What orbiframe itself writes into the arguments of every command.
RESERVED = ("command", "debug", "progress")


def there_is_something_to_run(component: Component, _: Lab) -> None:
    """The parser has the default `run`, a function of arguments and registry; so has every part of a command."""
    for parser in _parsers(_configured(component)):
        run = parser.get_default("run")
        assert callable(run), f"'{parser.prog}' sets no function: parser.set_defaults(run=run)"
        try:
            inspect.signature(run).bind(None, None)
        except TypeError as error:
            raise AssertionError(f"`run` of '{parser.prog}' must take (args, registry): {error}") from error


def help_says_all(component: Component, _: Lab) -> None:
    """--help can be printed, and every argument has a line in it."""
    for parser in _parsers(_configured(component)):
        assert parser.format_help().strip(), "the help is empty"
        for action in parser._actions:
            if not isinstance(action, argparse._SubParsersAction):
                name = "/".join(action.option_strings) or action.dest
                assert (action.help or "").strip(), f"'{parser.prog}': {name} has no help"


def names_are_free(component: Component, _: Lab) -> None:
    """The arguments get on with --debug and with what orbiframe adds to them."""
    for parser in _parsers(_configured(component)):
        own = [action for action in parser._actions if not set(action.option_strings) & set(_COMMON)]
        for action in own:
            assert action.dest not in (*RESERVED, "run"), f"'{action.dest}' is a name of orbiframe's own: take another"


def configuring_says_nothing(component: Component, _: Lab) -> None:
    """Adding arguments prints nothing, ends nothing, and gives the same arguments each time."""
    with redirect_stdout(StringIO()) as out, redirect_stderr(StringIO()) as err:
        first, second = (_configured(component).format_help() for _ in range(2))
    assert not out.getvalue() + err.getvalue(), f"configure prints {(out.getvalue() + err.getvalue())[:80]!r}"
    assert first == second, "the arguments differ from one time to the next"


def wrong_use_ends_with_2(component: Component, _: Lab) -> None:
    """An option that is not there ends the command with status 2, as argparse does."""
    parser = _configured(component)
    status: object = None
    try:
        with redirect_stderr(StringIO()):
            parser.parse_args(["--no-such-option-of-any-command"])
    except SystemExit as stop:
        status = stop.code
    assert status == 2, f"an option that is not there ends with {status}"


def _configured(component: Component) -> argparse.ArgumentParser:
    """A parser as orbiframe makes it, with the arguments of the command."""
    parser = argparse.ArgumentParser("orbiframe command")
    parser.add_argument("--debug", action="store_true", default=argparse.SUPPRESS, help="show the traceback")
    parser.add_argument("--progress", default=argparse.SUPPRESS, help="how to tell what goes on")
    component(parser)
    return parser


def _parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """The parser of a command and those of its parts, with the defaults that they inherit."""
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for part in dict.fromkeys(action.choices.values()):
                if part.get_default("run") is None:
                    part.set_defaults(run=parser.get_default("run"))
                yield from _parsers(part)


LAWS: tuple[Callable[[Component, Lab], None], ...] = (
    there_is_something_to_run,
    help_says_all,
    names_are_free,
    configuring_says_nothing,
    wrong_use_ends_with_2,
)


# ---- mutants: each breaks one law ---------------------------------------------------------------------------------


def _then(change: Callable[[argparse.ArgumentParser], Any]) -> Callable[[Component], Component]:
    def mutation(component: Component) -> Component:
        def changed(parser: argparse.ArgumentParser) -> None:
            component(parser)
            change(parser)

        return changed

    return mutation


def _swallow(parser: argparse.ArgumentParser) -> None:
    parser.parse_args = lambda *_: argparse.Namespace()  # type: ignore[method-assign, assignment]


MUTANTS: Mapping[str, Callable[[Component], Component]] = {
    "there_is_something_to_run": _then(lambda parser: parser.set_defaults(run=lambda _: 0)),
    "help_says_all": _then(lambda parser: parser.add_argument("--half", help="50 % of it")),
    "names_are_free": _then(lambda parser: parser.add_argument("--progress", help="another one")),
    "configuring_says_nothing": _then(lambda _: print("hello")),
    "wrong_use_ends_with_2": _then(_swallow),
}
