"""orbiframe view: a surface in a page of the browser, served on this machine alone."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from orbiframe import FormatError, Registry, UsageError
from orbiframe.files import add_repairs, located, repaired, repairs_asked, require_apart, require_output

if TYPE_CHECKING:
    from orbiframe import Polyhedron

_LAST_WORD = 3.0  # seconds that a page has to hear of an error


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add(
        "file",
        metavar="FILE",
        type=Path,
        help="a closed mesh, a saved surface (.npz), or a field (.ply, .vtu)",
    )
    add("-o", "--output", metavar="FILE.html", type=Path, help="write the page with its data, and serve nothing")
    add("--config", metavar="FILE.toml", type=Path, help="components and options of the fit of a mesh")
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help="one option, such as basis.size=200")
    add("--port", metavar="N", type=int, default=0, help="of the address; default: one that is free")
    add("--no-browser", action="store_true", help="print the address and open no browser")
    add_repairs(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Serve the page until the command is interrupted, or write it."""
    from orbiframe import Config

    args.file = located(args.file)
    if not args.file.exists():
        raise FormatError(f"{args.file}: there is no such file; name a mesh, a saved surface or a field")
    config = Config.load(args.config, args.set, registry)
    if args.output is not None:
        return _write(args, config, registry)
    return _serve(args, config, registry)


def _write(args: argparse.Namespace, config: object, registry: Registry) -> int:
    from orbiframe import Config
    from orbiframe.files import write_text
    from orbiframe_viewer.shown_file import scenes_of
    from orbiframe_viewer.static_page import static_page

    if args.output.suffix.lower() not in (".html", ".htm"):
        raise UsageError(f"{args.output}: a page is written as .html; give it this suffix")
    require_apart({"-o": args.output}, {"the input": args.file, "--config": args.config})
    require_output(args.output)
    assert isinstance(config, Config)
    scenes, png = scenes_of(args.file, config, registry, args.progress, _repair(args))
    write_text(args.output, static_page(scenes, png, args.file.stem))
    return 0


def _serve(args: argparse.Namespace, config: object, registry: Registry) -> int:
    from orbiframe import Config
    from orbiframe_viewer.server import address, serve
    from orbiframe_viewer.session import Session
    from orbiframe_viewer.shown_file import scenes_of

    assert isinstance(config, Config)
    session = Session(args.file.name)
    try:
        server = serve(session, args.port)
    except (OSError, OverflowError) as error:
        why = str(error).rstrip(".")
        raise UsageError(f"--port {args.port} cannot be served: {why}; leave it out for one that is free") from error
    where = address(server, session)
    print(f"{where}\nthe page is served until Ctrl-C", flush=True)
    if not args.no_browser:
        _open(where)

    def told(stage: str, seconds: float | None) -> None:
        session.stage(stage, seconds)
        args.progress(stage, seconds)

    try:
        session.finish(scenes_of(args.file, config, registry, told, _repair(args))[0])
        args.progress.close()
        args.progress.rest()
        while True:
            time.sleep(3600)
    except KeyboardInterrupt:
        return 0
    except Exception as error:
        session.fail(str(error))
        session.told.wait(_LAST_WORD)
        time.sleep(0.2)
        raise
    finally:
        server.shutdown()


def _repair(args: argparse.Namespace) -> Callable[[Polyhedron], Polyhedron] | None:
    """The repairs that are asked for, if any."""
    return (lambda mesh: repaired(mesh, args, args.say)) if repairs_asked(args) else None


def _open(where: str) -> None:
    import webbrowser

    webbrowser.open(where)
