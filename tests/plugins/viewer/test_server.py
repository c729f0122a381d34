"""The server of pages: who leaves amid an answer ends nothing."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

LEAVING = """
import signal, socket, struct, urllib.request
from orbiframe_viewer.server import HOST, Answer, Page, address, serve

class Large(Page):
    first, files, words = "large.bin", (), "orbiframe view"
    def asked(self, name, query):
        return Answer(bytes(1 << 24), "bin")

signal.signal(signal.SIGPIPE, signal.SIG_DFL)
page = Large()
server = serve(page)
for _ in range(5):
    with socket.create_connection((HOST, server.server_port)) as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        request = f"GET /{page.token}/large.bin HTTP/1.1\\r\\nHost: {HOST}:{server.server_port}\\r\\n\\r\\n"
        connection.sendall(request.encode())
        connection.recv(1000)
        connection.shutdown(socket.SHUT_WR)
with urllib.request.urlopen(address(server, page) + "large.bin") as answer:
    print(len(answer.read()))
"""


@pytest.mark.skipif(not hasattr(signal, "SIGPIPE"), reason="this system has no such signal")
def test_a_page_that_leaves_amid_an_answer_does_not_end_the_process():
    """Also where a library has taken back that Python ignores the signal for that, as Gmsh does."""
    ran = subprocess.run([sys.executable, "-c", LEAVING], capture_output=True, text=True, timeout=120, check=False)
    assert (ran.returncode, ran.stdout) == (0, f"{1 << 24}\n"), ran.stderr
