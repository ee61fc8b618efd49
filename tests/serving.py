"""A server in a process of its own, and a relay before it whose connections can be cut."""

from __future__ import annotations

import socket
import subprocess
import sys
import tempfile
import threading
import urllib.request
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from processes import PATIENCE_S
from typing_extensions import Self

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

PROGRAM = "import sys; from gym_babble import _core; raise SystemExit(_core.serve(sys.argv[1:]))"


@dataclass
class Served:
    """A running server."""

    process: subprocess.Popen[str]
    port: int

    @property
    def url(self) -> str:
        return f"ws://127.0.0.1:{self.port}"

    def metric(self, name: str) -> float:
        """A number of its metrics."""
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/metrics") as page:
            lines = page.read().decode().splitlines()
        return sum(float(line.split()[-1]) for line in lines if line.startswith(name))


@contextmanager
def served(*options: Any, port: int = 0, **environment: Any) -> Iterator[Served]:
    """A server, which is killed if it does not stop by itself."""
    with tempfile.TemporaryFile("w+") as log:
        process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM, "--port", str(port), *map(str, options)],
            stdout=subprocess.PIPE,
            stderr=log,
            text=True,
            **environment,
        )
        with process:
            try:
                line = process.stdout.readline()
                if not line.startswith("listening on "):
                    process.wait(PATIENCE_S)
                    log.seek(0)
                    raise AssertionError(f"the server does not listen: {line} {log.read()}")
                yield Served(process, int(line.rpartition(":")[2]))
            finally:
                process.terminate()
                with suppress(subprocess.TimeoutExpired):
                    process.wait(PATIENCE_S)
                process.kill()


@dataclass
class Relay:
    """Passes bytes on between clients and a server, until it is told to cut.

    `cut` is asked of each piece of data after the WebSocket's handshake, and says how many of its
    bytes still pass before the connection breaks; None for all, and no break.
    """

    port: int
    cut: Callable[[bool, int], int | None] = lambda _up, _size: None
    connections: int = 0
    breaks: int = 0
    _sockets: list[socket.socket] = field(default_factory=list)

    def __enter__(self) -> Self:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._accepting = threading.Thread(target=self._accept)
        self._accepting.start()
        return self

    def __exit__(self, *_: object) -> None:
        # Closing alone wakes nobody who waits for a connection.
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self.break_all()
        self._accepting.join(PATIENCE_S)

    @property
    def url(self) -> str:
        return f"ws://127.0.0.1:{self._listener.getsockname()[1]}"

    def break_all(self) -> None:
        """Breaks the connections that there are."""
        broken, self._sockets = self._sockets, []
        for one in broken:
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)

    def _accept(self) -> None:
        while True:
            try:
                client, _ = self._listener.accept()
            except OSError:
                return
            server = socket.create_connection(("127.0.0.1", self.port))
            self.connections += 1
            for one in (client, server):
                one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._sockets.append(one)
            for source, to, up in ((client, server, True), (server, client, False)):
                threading.Thread(target=self._pass, args=(source, to, up), daemon=True).start()

    def _pass(self, source: socket.socket, to: socket.socket, up: bool) -> None:
        first = True
        with suppress(OSError):
            while data := source.recv(1 << 20):
                passing = None if first else self.cut(up, len(data))
                first = False
                to.sendall(data if passing is None else data[:passing])
                if passing is not None:
                    self.breaks += 1
                    break
        for one in (source, to):
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
            one.close()
