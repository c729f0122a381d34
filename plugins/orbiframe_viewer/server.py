"""Server: the page of the viewer on this machine alone, for who knows the token in its address."""

from __future__ import annotations

import gzip
import hmac
import json
import secrets
import threading
from collections.abc import Sequence
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from orbiframe_viewer.scene import Scene
from orbiframe_viewer.static_page import part

HOST = "127.0.0.1"
_KINDS = {"html": "text/html", "css": "text/css", "js": "text/javascript", "json": "application/json"}
_FILES = ("viewer.css", "viewer.js", "three.min.js")
_POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data: blob:"


class Session:
    """What the page asks for: the stage of the work, and at its end the scenes or the error."""

    def __init__(self, name: str) -> None:
        self.token = secrets.token_urlsafe(24)
        self.told = threading.Event()  # whether a page has heard of the end
        self._lock = threading.Lock()
        self._state: dict[str, Any] = {"name": name, "stages": [], "ready": False, "error": None}
        self._scenes = b""

    def stage(self, name: str, seconds: float | None) -> None:
        """Hear of a stage, as progress is told."""
        with self._lock:
            stages = self._state["stages"]
            if seconds is None:
                stages.append([name, None])
            elif stages and stages[-1][0] == name:
                stages[-1][1] = round(seconds, 2)

    def finish(self, scenes: Sequence[Scene]) -> None:
        """The scenes are there."""
        content = gzip.compress(json.dumps(list(scenes)).encode(), 1)
        with self._lock:
            self._scenes, self._state["ready"] = content, True

    def fail(self, error: str) -> None:
        """There will be none."""
        with self._lock:
            self._state["error"] = error

    @property
    def state(self) -> bytes:
        """The state as JSON."""
        with self._lock:
            if self._state["error"]:
                self.told.set()
            return json.dumps(self._state).encode()

    @property
    def scenes(self) -> bytes:
        """The scenes as JSON, compressed; empty before they are there."""
        with self._lock:
            return self._scenes


def serve(session: Session, port: int = 0) -> ThreadingHTTPServer:
    """Begin to serve a session, in threads beside; port 0: one that is free. Raises OSError for one that is not."""

    class Own(_Handler):
        """The requests of this session."""

    server = ThreadingHTTPServer((HOST, port), Own)
    Own.session, Own.port = session, server.server_port
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server


def address(server: ThreadingHTTPServer, session: Session) -> str:
    """The address of the page."""
    return f"http://{HOST}:{server.server_port}/{session.token}/"


class _Handler(BaseHTTPRequestHandler):
    session: Session
    port: int
    server_version, sys_version = "orbiframe", ""

    def do_GET(self) -> None:
        """A file of the page, the state or the scenes."""
        _, token, *rest = self.path.partition("?")[0].split("/")
        port = self.port
        # A page of another name that leads here, by a name server that lies, knows no token, and is told nothing.
        if self.headers.get("Host") not in (f"{HOST}:{port}", f"localhost:{port}"):
            self._send(403, b"this address is served to 127.0.0.1 alone\n", "html")
        elif not hmac.compare_digest(token.encode(), self.session.token.encode()):
            self._send(403, b"wrong token: open the address that `orbiframe view` printed\n", "html")
        elif rest == [""]:
            self._send(200, part("index.html").encode(), "html")
        elif rest == ["state.json"]:
            self._send(200, self.session.state, "json")
        elif rest == ["scenes.json"] and self.session.scenes:
            self._send(200, self.session.scenes, "json", packed=True)
        elif len(rest) == 1 and rest[0] in _FILES:
            self._send(200, part(rest[0]).encode(), rest[0].rpartition(".")[2])
        else:
            self._send(404, b"there is no such file\n", "html")

    def _send(self, status: int, content: bytes, kind: str, *, packed: bool = False) -> None:
        self.send_response(status)
        self.send_header("Content-Type", f"{_KINDS[kind]}; charset=utf-8")
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Content-Security-Policy", _POLICY)
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        if packed:
            self.send_header("Content-Encoding", "gzip")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:
        """Requests are not told."""
