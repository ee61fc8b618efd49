"""One WebSocket, in the thread of its user: messages out and in."""

from __future__ import annotations

import socket
import ssl
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from gym_babble.checks import shown
from gym_babble.errors import ConfigError, MissingExtraError, ServerError

try:
    from websockets.client import ClientProtocol
    from websockets.exceptions import InvalidStatus, InvalidURI, WebSocketException
    from websockets.frames import CloseCode, Frame, Opcode
    from websockets.protocol import State
    from websockets.uri import parse_uri
except ImportError as error:
    raise MissingExtraError("websockets", "remote") from error

if TYPE_CHECKING:
    from websockets.uri import WebSocketURI

__all__ = ["BrokenChannelError", "Channel", "read_url"]

SUBPROTOCOL: Any = "gym-babble.v1"
DATA = (Opcode.BINARY, Opcode.CONT)
READ_BYTES = 65_536


class BrokenChannelError(Exception):
    """The connection ended, without a word of the server or with code and reason."""

    def __init__(self, code: int | None, reason: str) -> None:
        super().__init__(reason)
        self.code = code
        self.reason = reason


def read_url(url: Any) -> WebSocketURI:
    """The address of a server; the path is `/ws` if there is none.

    Raises:
        ConfigError: It is not a `ws://` or `wss://` address.
    """
    try:
        uri = parse_uri(url)
    except (InvalidURI, TypeError, ValueError, AttributeError) as error:
        raise ConfigError(f"url = {shown(url)} is not like ws://127.0.0.1:8741") from error
    if uri.path in ("", "/"):
        uri.path = "/ws"
    return uri


class Channel:
    """A WebSocket that speaks the binary protocol.

    Args:
        uri: Address of the server.
        token: Access token, if the server wants one.
        deadline: When to give up, by `time.monotonic` [s].

    Raises:
        OSError: No connection, or none in time.
        ServerError: The server refuses the connection, or speaks another protocol.
    """

    def __init__(self, uri: WebSocketURI, token: str | None, deadline: float) -> None:
        self._socket: socket.socket = socket.create_connection(
            (uri.host, uri.port), timeout=_left(deadline)
        )
        try:
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            if uri.secure:
                context = ssl.create_default_context()
                self._socket = context.wrap_socket(self._socket, server_hostname=uri.host)
            self._protocol = ClientProtocol(uri, subprotocols=[SUBPROTOCOL], max_size=None)
            self._shake_hands(token, deadline)
        except BaseException:
            self._socket.close()
            raise

    def _shake_hands(self, token: str | None, deadline: float) -> None:
        request = self._protocol.connect()
        if token is not None:
            request.headers["Authorization"] = f"Bearer {token}"
        self._protocol.send_request(request)
        self._flush()
        while self._protocol.state is State.CONNECTING and self._protocol.handshake_exc is None:
            self._read(deadline)
        refused = self._protocol.handshake_exc
        if isinstance(refused, InvalidStatus):
            response = refused.response
            body = bytes(response.body or b"").decode("utf-8", "replace").strip()
            raise ServerError(f"it refuses the connection: {response.status_code} {body}")
        if refused is not None or self._protocol.subprotocol != SUBPROTOCOL:
            raise ServerError(f"it does not speak {SUBPROTOCOL}") from refused

    def send(self, message: bytes, deadline: float) -> None:
        """Sends a message.

        Raises:
            OSError: The connection broke, or the server took too long to read.
            BrokenChannelError: The connection has ended.
        """
        if self._protocol.state is not State.OPEN:
            raise self._broken()
        self._protocol.send_binary(message)
        self._socket.settimeout(_left(deadline))
        self._flush()

    def receive(self, deadline: float) -> bytes:
        """The next message.

        Raises:
            OSError: The connection broke, or no message came in time.
            BrokenChannelError: The connection has ended.
        """
        parts: list[bytes] = []
        while True:
            for frame in self._protocol.events_received():
                if isinstance(frame, Frame) and frame.opcode in DATA:
                    parts.append(bytes(frame.data))
                    if frame.fin:
                        return parts[0] if len(parts) == 1 else b"".join(parts)
            if self._protocol.state is not State.OPEN:
                raise self._broken()
            self._read(deadline)

    def answer_pings(self) -> None:
        """Answers the pings that have come; for use while no reply is awaited.

        Raises:
            OSError: The connection broke.
            BrokenChannelError: The connection has ended.
        """
        self._socket.settimeout(0)
        with suppress(BlockingIOError, ssl.SSLWantReadError):
            self._take(self._socket.recv(READ_BYTES))
        if self._protocol.state is not State.OPEN:
            raise self._broken()

    def close(self, deadline: float) -> None:
        """Closes the connection, with the WebSocket's farewell if the server is still there."""
        with suppress(OSError, WebSocketException):
            self._protocol.send_close(CloseCode.NORMAL_CLOSURE)
            self._socket.settimeout(_left(deadline))
            self._flush()
            while self._protocol.state is not State.CLOSED:
                self._read(deadline)
        self._socket.close()

    def abandon(self) -> None:
        """Closes the connection without a word."""
        self._socket.close()

    def _read(self, deadline: float) -> None:
        self._socket.settimeout(_left(deadline))
        self._take(self._socket.recv(READ_BYTES))

    def _take(self, data: bytes) -> None:
        if data:
            self._protocol.receive_data(data)
        else:
            self._protocol.receive_eof()
        try:
            self._flush()
        except OSError:
            # A server that has ended the connection no longer hears the answer.
            if self._protocol.state is State.OPEN:
                raise

    def _flush(self) -> None:
        """Sends what the protocol has to say: messages, and answers to pings and closes."""
        for data in self._protocol.data_to_send():
            if data:
                self._socket.sendall(data)

    def _broken(self) -> BrokenChannelError:
        close = self._protocol.close_rcvd
        if close is None:
            return BrokenChannelError(None, "the connection broke")
        return BrokenChannelError(close.code, close.reason)


def _left(deadline: float) -> float:
    """Seconds until a deadline.

    Raises:
        TimeoutError: It has passed.
    """
    left = deadline - time.monotonic()
    if left <= 0:
        raise TimeoutError("timed out")
    return left
