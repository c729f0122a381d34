"""Server: a page on this machine alone, for who knows the token in its address."""

from __future__ import annotations

import hmac
import json
import secrets
import signal
import threading
from abc import ABC, abstractmethod
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, NamedTuple
from urllib.parse import parse_qsl

from orbiframe_viewer.static_page import part

HOST = "127.0.0.1"
_KINDS = {
    "html": "text/html; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "js": "text/javascript; charset=utf-8",
    "json": "application/json; charset=utf-8",
    "bin": "application/octet-stream",
}
_POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data: blob:"
_MOST = 1 << 20  # bytes of what a page sends


class Answer(NamedTuple):
    """What is sent to a page: packed says whether it is compressed."""

    content: bytes
    kind: str
    packed: bool = False
    status: int = 200


class Page(ABC):
    """What is served: the files of a page, and what it asks for by name.

    files: those that anybody with the token gets, `first` for the address itself; words: the command, for who has none.
    """

    first: str
    files: tuple[str, ...]
    words: str

    def __init__(self) -> None:
        self.token = secrets.token_urlsafe(24)

    @abstractmethod
    def asked(self, name: str, _query: dict[str, str]) -> Answer | None:
        """The answer to a request; None where there is nothing of this name."""

    def sent(self, _name: str, _body: Any) -> Answer | None:
        """The answer to what a page sends; None where nothing is taken."""
        return None


def serve(page: Page, port: int = 0) -> ThreadingHTTPServer:
    """Begin to serve a page, in threads beside; port 0: one that is free. Raises OSError for one that is not."""

    class Own(_Handler):
        """The requests of this page."""

    server = ThreadingHTTPServer((HOST, port), Own)
    Own.page, Own.port = page, server.server_port
    threading.Thread(target=_answer, args=(server,), daemon=True).start()
    return server


def _answer(server: ThreadingHTTPServer) -> None:
    """Answer in this thread and those that it begins: a page that leaves amid an answer never ends the process.

    Python ignores the signal for that, until a library such as Gmsh has it end the process again.
    """
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
    server.serve_forever()


def address(server: ThreadingHTTPServer, page: Page) -> str:
    """The address of the page."""
    return f"http://{HOST}:{server.server_port}/{page.token}/"


def _refusal(words: str, status: int) -> Answer:
    return Answer(f"{words}\n".encode(), "html", status=status)


class _Handler(BaseHTTPRequestHandler):
    page: Page
    port: int
    server_version, sys_version = "orbiframe", ""

    def do_GET(self) -> None:
        """A file of the page, or what it asks for."""
        path, _, query = self.path.partition("?")
        _, token, *rest = path.split("/")
        refusal = self._refused(token)
        if refusal is not None or len(rest) != 1:
            self._send(refusal or _refusal("there is no such file", 404))
            return
        name = rest[0] or self.page.first
        if not rest[0] or name in self.page.files:
            self._send(Answer(part(name).encode(), name.rpartition(".")[2]))
            return
        self._send(self.page.asked(name, dict(parse_qsl(query))) or _refusal("there is no such file", 404))

    def do_POST(self) -> None:
        """What the page sends, as JSON."""
        _, token, *rest = self.path.split("/")
        size = self.headers.get("Content-Length", "")
        if refusal := self._refused(token):
            self._send(refusal)
        elif not size.isdecimal() or int(size) > _MOST or len(rest) != 1:
            self._send(_refusal("this is not taken", 400))
        else:
            self._send(self._taken(rest[0], self.rfile.read(int(size))))

    def _taken(self, name: str, content: bytes) -> Answer:
        try:
            body = json.loads(content)
        except ValueError:
            return _refusal("this is no JSON", 400)
        return self.page.sent(name, body) or _refusal("this is not taken", 404)

    def _refused(self, token: str) -> Answer | None:
        """Why a request is not answered, if it is not.

        A page of another name that leads here, by a name server that lies, knows no token, and is told nothing.
        """
        hosts = (f"{HOST}:{self.port}", f"localhost:{self.port}")
        if self.headers.get("Host") not in hosts:
            return _refusal("this address is served to 127.0.0.1 alone", 403)
        if self.headers.get("Origin") not in (None, *(f"http://{host}" for host in hosts)):
            return _refusal("this address is served to its own page alone", 403)
        if not hmac.compare_digest(token.encode(), self.page.token.encode()):
            return _refusal(f"wrong token: open the address that `{self.page.words}` printed", 403)
        return None

    def _send(self, answer: Answer) -> None:
        self.send_response(answer.status)
        self.send_header("Content-Type", _KINDS[answer.kind])
        self.send_header("Content-Length", str(len(answer.content)))
        self.send_header("Content-Security-Policy", _POLICY)
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        if answer.packed:
            self.send_header("Content-Encoding", "gzip")
        self.end_headers()
        self.wfile.write(answer.content)

    def log_message(self, format: str, *args: Any) -> None:
        """Requests are not told."""
