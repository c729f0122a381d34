"""orbiframe edit: a surface that follows its mesh in a page of the browser, served on this machine alone."""

from __future__ import annotations

import argparse
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbiframe import FormatError, Registry, UsageError
from orbiframe.files import add_repairs, located, repaired, repairs_asked, require_apart, require_output

if TYPE_CHECKING:
    from orbiframe import Config, OrbifoldSurface, Polyhedron
    from orbiframe_viewer.edit_session import EditSession

SURFACES = (".npz", ".orbi")
_LAST_WORD = 3.0  # seconds that a page has to hear of an error
_PLAIN = ".off"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("file", metavar="MESH", type=Path, help="a mesh, or a saved surface (.npz), whose map is taken over")
    add(
        "-o",
        "--output",
        metavar="OUT",
        type=Path,
        help="the mesh that is saved, with OUT.npz and OUT.toml beside it; default MESH-edited.off",
    )
    add("--config", metavar="FILE.toml", type=Path, help="components and options of the fit")
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help="one option, such as basis.size=200")
    add("--port", metavar="N", type=int, default=0, help="of the address; default: one that is free")
    add("--no-browser", action="store_true", help="print the address and open no browser")
    add_repairs(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace, registry: Registry) -> int:
    """Serve the page until the command is interrupted; what is not saved then is kept in files of another name."""
    from orbiframe import Config

    args.file = located(args.file)
    if not args.file.exists():
        raise FormatError(f"{args.file}: there is no such file; name a mesh or a saved surface")
    config = Config.load(args.config, args.set, registry)
    target = _target(args)
    with _interrupted_by_signals():
        return _serve(args, config, registry, target)


def _target(args: argparse.Namespace) -> Path:
    """The mesh that is saved. Raises UsageError for files of the user that it would replace."""
    from orbiframe_viewer.edited_files import files_beside

    if args.output is None:
        return _free(Path(f"{args.file.stem}-edited{_suffix(args.file)}"))
    target: Path = args.output
    inputs = {"the input": args.file, "--config": args.config}
    for path in (target, *files_beside(target)):
        require_apart({"-o": path}, inputs)
        require_output(path)
    if target.suffix.lower() in (*SURFACES, ".toml"):
        raise UsageError(f"{target}: -o is the mesh; the surface and the configuration go beside it")
    return target


def _suffix(file: Path) -> str:
    return _PLAIN if file.suffix.lower() in SURFACES else file.suffix


def _free(path: Path) -> Path:
    """The path, or one with a number, where nothing of that name is yet."""
    from orbiframe_viewer.edited_files import files_beside

    number, found = 2, path
    while any(each.exists() for each in (found, *files_beside(found))):
        number, found = number + 1, path.with_stem(f"{path.stem}-{number}")
    return found


def _serve(args: argparse.Namespace, config: Config, registry: Registry, target: Path) -> int:
    from orbiframe_viewer.edit_session import EditSession
    from orbiframe_viewer.edited_files import saver
    from orbiframe_viewer.server import address, serve

    session = EditSession(
        args.file.name, config, registry, lambda fit: saver(target, session.mesh, session.base, registry)(fit)
    )
    try:
        server = serve(session, args.port)
    except (OSError, OverflowError) as error:
        why = str(error).rstrip(".")
        raise UsageError(f"--port {args.port} cannot be served: {why}; leave it out for one that is free") from error
    where = address(server, session)
    print(f"{where}\nthe page is served until Ctrl-C; it saves {target}", flush=True)
    if not args.no_browser:
        _open(where)
    try:
        _begin(session, args, registry)
        args.progress.close()
        args.progress.rest()
        threading.Thread(target=session.work, daemon=True).start()
        while True:
            time.sleep(3600)
    except KeyboardInterrupt:
        return 0
    except Exception as error:
        session.fail(str(error))
        time.sleep(_LAST_WORD)
        raise
    finally:
        session.end()
        server.shutdown()
        _recover(session, target, args, registry)


def _begin(session: EditSession, args: argparse.Namespace, registry: Registry) -> None:
    """The first fit."""
    from orbiframe_viewer.draft import Draft
    from orbiframe_viewer.first_fit import first_fit

    def told(stage: str, seconds: float | None) -> None:
        session.stage(stage, seconds)
        args.progress(stage, seconds)

    surface, mesh = _read(args, session.base, registry)
    session.base, first = first_fit(mesh, surface, session.base, registry, told)
    draft: Draft = first.draft
    session.begin(first.result.input, draft, first)


def _read(args: argparse.Namespace, config: Config, registry: Registry) -> tuple[OrbifoldSurface | None, Polyhedron]:
    """The mesh to be edited, and the surface where one was saved."""
    from orbiframe import load_surface, read

    if args.file.suffix.lower() in SURFACES:
        if repairs_asked(args):
            raise UsageError(f"{args.file}: a saved surface needs no repairs; leave these options out")
        surface = load_surface(args.file, registry)
        own = surface.own_mesh
        return surface, own.with_vertices(surface.origin + surface.scale * own.vertices)
    format = None if config.mesh.open else config.mesh.name
    mesh = read(args.file, registry, format=format, degenerate=args.drop_degenerate)
    return None, repaired(mesh, args, args.say)


def _recover(session: EditSession, target: Path, args: argparse.Namespace, registry: Registry) -> None:
    """Write what is not saved under another name, and say so."""
    from orbiframe_viewer.edited_files import save_draft

    if session.history is None or not session.history.unsaved:
        return
    path = _free(target.with_stem(f"{target.stem}-unsaved"))
    files = save_draft(path, session.mesh, session.history.now, session.base, registry)
    args.say(
        f"changes were not saved: they are in {' and '.join(file.name for file in files)}; go on with `orbiframe edit "
        f"{files[0]} --config {files[1]}`"
    )


@contextmanager
def _interrupted_by_signals() -> Iterator[None]:
    """A closed terminal and a request to end are as Ctrl-C: nothing is lost."""

    def interrupt(*_: Any) -> None:
        raise KeyboardInterrupt

    names = [name for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    if threading.current_thread() is not threading.main_thread():
        names = []
    before = {name: signal.signal(getattr(signal, name), interrupt) for name in names}
    try:
        yield
    finally:
        for name, handler in before.items():
            signal.signal(getattr(signal, name), handler)


def _open(where: str) -> None:
    import webbrowser

    webbrowser.open(where)
