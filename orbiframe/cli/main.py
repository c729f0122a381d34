"""The command line: finds the command, runs it, and turns errors into one sentence and an exit status."""

from __future__ import annotations

import argparse
import sys
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.metadata import version
from itertools import pairwise

from orbiframe.cli import plugin as commands
from orbiframe.cli.blame import named
from orbiframe.cli.patience import patient
from orbiframe.cli.progress import MODES, Progress, compilation_told
from orbiframe.cli.speech import any_letter, fill_closed_streams, said_to_programs, say, silence
from orbiframe.components.registry import Registry
from orbiframe.errors import OrbiframeError, PluginError, UsageError
from orbiframe.workers.linear_algebra import one_thread_by_default

INTERRUPTED = 130
EPILOG = (
    "exit status: 0 done; 1 the data or the mathematics do not allow it; 2 wrong usage or configuration; "
    "3 a fit is done, and its report warns"
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status.

    0: done; 1: the data or the mathematics do not allow it; 2: wrong usage or configuration; 3: a fit is done, and its
    report warns; 130: interrupted. Errors are one sentence on the standard error stream, with a traceback only after
    `--debug`.
    """
    arguments = sys.argv[1:] if argv is None else list(argv)
    one_thread_by_default()
    fill_closed_streams()
    with warnings.catch_warnings(), any_letter(), said_to_programs(_mode(arguments) == "json"):
        debug = "--debug" in arguments
        _show_warnings_of_users(debug)
        try:
            status = _run(arguments)
        except SystemExit as stop:
            status = stop.code if isinstance(stop.code, int) else 0
        except (Exception, KeyboardInterrupt) as error:
            status = 0 if isinstance(error, BrokenPipeError) else _report(error, debug)
        return _flushed(status)


def _mode(arguments: Sequence[str]) -> str:
    """How progress is to be told, as far as the words say it: with JSON wrong arguments are told in it too."""
    joined = [word.partition("=")[2] for word in arguments if word.startswith("--progress=")]
    return joined[-1] if joined else dict(pairwise(arguments)).get("--progress", "auto")


def _run(arguments: list[str]) -> int:
    registry = Registry.discover()
    registry.register("commands", commands)
    for plugin, seconds in registry.slow:
        say(f"the plugin '{plugin}' took {seconds:.1f} s to declare itself; it should import nothing heavy for that")
    quiet = "--quiet" in arguments or _mode(arguments) != "auto"
    try:
        with patient(_command(arguments) or "orbiframe", quiet=quiet) as rest:
            args = parsed(arguments, registry)
            args.progress.rest = rest
            with _told(args.progress, args.command):
                return _status(args.run(args, registry), args, registry)
    except Exception as error:
        told = named(error, registry)
        if told is error:
            raise
        raise told from error


@contextmanager
def _told(progress: Progress, command: str) -> Iterator[None]:
    """Meanwhile a program hears that the command goes on, and everybody that functions are being compiled."""
    progress.watch(command)
    try:
        with compilation_told(quiet=progress.mode == "none", json=progress.mode == "json"):
            yield
    finally:
        progress.close()


def _status(found: object, args: argparse.Namespace, registry: Registry) -> int:
    """What a command gives back, if it is an exit status. Raises PluginError otherwise."""
    if not isinstance(found, int):
        title = registry.title(registry.component("command", args.command))
        raise PluginError(f"{title} gives {found!r}; its function `run` must return 0, 1 or 2")
    return found


def parsed(arguments: list[str], registry: Registry) -> argparse.Namespace:
    """A command of a registry with its arguments; to be run as `args.run(args, registry)`.

    What takes long is told to `args.progress`, a stage at a time: (name, None), then (name, seconds); a sentence for
    the standard error stream to `args.say`.
    Raises UsageError for an unknown command and SystemExit for wrong arguments.
    """
    chosen = _command(arguments)
    parser = _parser(registry, chosen)
    if chosen is not None:
        registry.component("command", chosen)
    parser.set_defaults(run=lambda *_: _print_help(parser))
    args = parser.parse_args(arguments)
    args.command, args.words = chosen or "", tuple(arguments)
    args.say = say
    args.progress = Progress(quiet=getattr(args, "quiet", False), mode=args.progress)
    return args


def _command(arguments: list[str]) -> str | None:
    return next((word for word in arguments if not word.startswith("-")), None)


def _print_help(parser: argparse.ArgumentParser) -> int:
    parser.print_help()
    return 0


def whole_parser(registry: Registry) -> argparse.ArgumentParser:
    """The parser of all commands with all their arguments; commands that cannot be imported have none."""
    return _parser(registry, None, whole=True)


def _parser(registry: Registry, chosen: str | None, *, whole: bool = False) -> argparse.ArgumentParser:
    """The parser of all commands; only the chosen one is imported and has its arguments, or all."""
    parser = argparse.ArgumentParser("orbiframe", description=_description(), epilog=EPILOG)
    parser.add_argument("--version", action="version", version=f"orbiframe {version('orbiframe')}")
    _add_common(parser, False, "auto")
    subparsers = parser.add_subparsers(metavar="COMMAND", title="commands")
    for component in registry.components("command"):
        sub = subparsers.add_parser(component.name, help=component.summary, description=component.summary)
        _add_common(sub, argparse.SUPPRESS, argparse.SUPPRESS)
        if component.name == chosen:
            registry.load("command", component.name)(sub)
        elif whole:
            with suppress(PluginError):
                registry.load("command", component.name)(sub)
    return parser


def _description() -> str:
    return "One truly smooth surface from any closed polyhedron: spline orbifolds for every genus, orientable or not."


def _add_common(parser: argparse.ArgumentParser, debug: object, progress: str) -> None:
    parser.add_argument("--debug", action="store_true", default=debug, help="show the traceback of an error")
    parser.add_argument(
        "--progress", choices=MODES, default=progress, help="on long work: auto, on terminals; json, for programs; none"
    )


def _show_warnings_of_users(debug: bool) -> None:
    """Warnings that our own code gives to users are shown as one line; those of libraries only after --debug."""
    if not debug:
        warnings.simplefilter("ignore")
        warnings.filterwarnings("always", category=UserWarning)
        warnings.showwarning = lambda message, *_, **__: say(f"warning: {message}")


def _report(error: BaseException, debug: bool) -> int:
    if debug:
        traceback.print_exception(error)
    if isinstance(error, OSError) and error.filename is None:
        return _lost(error)
    say(_sentence(error))
    if isinstance(error, KeyboardInterrupt):
        return INTERRUPTED
    return 2 if isinstance(error, UsageError) else 1


def _sentence(error: BaseException) -> str:
    if isinstance(error, KeyboardInterrupt):
        return str(error) or "interrupted"
    if isinstance(error, MemoryError):
        return "not enough memory; take a smaller mesh, basis or refinement"
    if isinstance(error, OrbiframeError | OSError):
        return str(error)
    return f"internal error, {type(error).__name__}: {error}; run again with --debug for the traceback, and report it"


def _flushed(status: int) -> int:
    """The status, once all is said; another one if the standard output, full for example, does not take it.

    A reader that has gone (as in `orbiframe plugins | head`) is no error: nothing more can or need be said.
    """
    try:
        _flush()
    except BrokenPipeError:
        silence(sys.stdout)
    except OSError as error:
        return status or _lost(error)
    return status


def _lost(error: OSError) -> int:
    """Say that the standard output takes nothing any more; errors of files have their names."""
    silence(sys.stdout)
    say(f"the standard output cannot be written: {error.strerror}; files that were asked for are made")
    return 1


def _flush() -> None:
    if sys.stdout is not None:
        sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
