"""A session with a server: requests, each executed once, also if the connection breaks."""

from __future__ import annotations

import logging
import os
import time
from contextlib import suppress
from threading import Event, Lock, Thread
from typing import Any

from gymnasium.error import ClosedEnvironmentError, ResetNeeded

from gym_babble import errors
from gym_babble.errors import (
    LimitError,
    MissingExtraError,
    ServerError,
    ServerTimeoutError,
    SessionLostError,
)
from gym_babble.remote.channel import BrokenChannelError, Channel, read_url

try:
    from msgspec import DecodeError, msgpack
except ImportError as error:
    raise MissingExtraError("msgspec", "remote") from error

__all__ = ["Session"]

logger = logging.getLogger(__name__)

KINDS: dict[str, type[Exception]] = {
    "ConfigError": errors.ConfigError,
    "ActionError": errors.ActionError,
    "ScenarioError": errors.ScenarioError,
    "SnapshotError": errors.SnapshotError,
    "ResetNeeded": ResetNeeded,
    "LimitError": LimitError,
    "SessionError": SessionLostError,
}
"""Exceptions by the names that the server gives them."""

TOO_LONG = 1009
ENDED = (1000, 1001, 1011)
"""Codes of a close with which the server ends a session for good."""
ATTEND_S = 5.0
"""How often pings are answered while nothing else is asked [s]."""
RETRY_S = 0.2
"""Time between two tries to connect again [s]."""
ASIDE_S = 2.0
"""How long closing, and connecting again while nothing is asked, may take [s]."""


class Session:
    """A batch of environments on a server.

    Requests go out one after the other. If the connection breaks, the session is resumed on a new
    one and the request sent again; the server executes a request of the same id once.

    Args:
        url: Address of the server.
        token: Access token, if the server wants one.
        timeout: How long a request, or connecting again, may take [s].
        asked: The body of `make`: what environments.

    Raises:
        ConfigError: The address or an argument of the environments is invalid.
        LimitError: The server does not allow this many.
        ServerError: The server cannot be reached, or refuses the connection.
    """

    def __init__(self, url: str, token: str | None, timeout: float, asked: dict[str, Any]) -> None:
        self._uri = read_url(url)
        self._url = url
        self._token = token
        self._timeout = timeout
        self._lock = Lock()
        self._lost = ""
        self._process = os.getpid()
        self._closed = Event()
        deadline = time.monotonic() + timeout
        self._channel: Channel | None = self._connected(deadline)
        try:
            self.made: dict[str, Any] = self._enter("make", asked, deadline)
        except BaseException as error:
            self._drop()
            if isinstance(error, SessionLostError):  # There was none to lose.
                raise ServerError(f"{url}: {error}") from error
            raise
        self._last: int = 0
        self._attendant = Thread(target=self._attend, name="gym-babble pings", daemon=True)
        self._attendant.start()

    def request(self, operation: str, body: dict[str, Any]) -> Any:
        """The server's reply.

        Raises:
            gymnasium.error.ClosedEnvironmentError: The session was closed.
            SessionLostError: The session has ended on the server.
            ServerTimeoutError: No reply in time. Whether the request was executed is unknown.
            ServerError: The server cannot be reached, or has a fault.
            BabbleError: What the server says of the request, as the local environment would.
        """
        self._check()
        with self._lock:
            deadline = time.monotonic() + self._timeout
            try:
                return self._exchange(operation, body, deadline)
            except TimeoutError as error:
                self._drop()
                raise ServerTimeoutError(
                    f"{self._url}: no reply to {operation!r} within {self._timeout:g} s; whether "
                    "the server executed it is unknown"
                ) from error
            except BaseException as error:
                # After Ctrl-C a late reply must not be taken for that of the next request.
                if not isinstance(error, tuple(KINDS.values())):
                    self._drop()
                raise

    def _check(self) -> None:
        if self._closed.is_set():
            raise ClosedEnvironmentError("the environment is closed")
        if self._lost:
            raise SessionLostError(self._lost)
        if os.getpid() != self._process:
            raise ServerError(
                "a remote environment belongs to the process that made it; make one in each process"
            )

    def _exchange(self, operation: str, body: dict[str, Any], deadline: float) -> Any:
        if self._channel is None:
            self._resume(deadline)
        number = self._last + 1
        message = msgpack.encode([number, operation, body])
        most = self.made["limits"]["message_bytes"]
        if len(message) > most:
            raise LimitError(
                f"{operation!r} has {len(message)} bytes: this server allows at most {most}"
            )
        while True:
            try:
                reply = self._told(message, deadline)
                break
            except TimeoutError:
                raise
            except (OSError, BrokenChannelError) as error:
                self._drop()
                self._heed(error)
                logger.warning("%s: %s; connecting again", self._url, error)
            self._resume(deadline)
            if self._last not in (number - 1, number):
                raise self._lose("another client has used the session")
        self._last = number
        return self._read(reply, number)

    def _told(self, message: bytes, deadline: float) -> bytes:
        assert self._channel is not None
        self._channel.send(message, deadline)
        return self._channel.receive(deadline)

    def _heed(self, error: Exception) -> None:
        """Raises if the server ended the connection on purpose: coming back would not help."""
        if not isinstance(error, BrokenChannelError):
            return
        if error.code == TOO_LONG:
            raise LimitError(error.reason)
        if error.code in ENDED:
            raise self._lose(error.reason)

    def _lose(self, reason: str) -> SessionLostError:
        self._lost = f"{self._url}: {reason}; make a new environment"
        return SessionLostError(self._lost)

    def _resume(self, deadline: float) -> None:
        """Connects again and takes up the session.

        Raises:
            SessionLostError: The server has no such session any more.
            ServerError: The server cannot be reached before the deadline.
        """
        while True:
            try:
                self._channel = self._connected(deadline)
                made = self._enter("resume", {"key": self.made["key"]}, deadline)
            except SessionLostError as error:  # noqa: PERF203 - tried again until the deadline
                raise self._lose(str(error)) from None
            except (LimitError, ServerError) as error:
                self._drop()
                if time.monotonic() + RETRY_S > deadline:
                    raise ServerError(f"{self._url}: cannot connect again: {error}") from error
                time.sleep(RETRY_S)
            else:
                self._last = made["last"]
                return

    def _connected(self, deadline: float) -> Channel:
        try:
            return Channel(self._uri, self._token, deadline)
        except ServerError as error:
            raise ServerError(f"{self._url}: {error}") from error
        except OSError as error:
            raise ServerError(
                f"{self._url}: no server answers ({error}); start one with: gym-babble serve"
            ) from error

    def _enter(self, operation: str, body: dict[str, Any], deadline: float) -> dict[str, Any]:
        """Makes or resumes the session on a new connection."""
        try:
            reply = self._told(msgpack.encode([0, operation, body]), deadline)
        except (OSError, BrokenChannelError) as error:
            raise ServerError(f"{self._url}: {operation!r} was not answered: {error}") from error
        made: dict[str, Any] = self._read(reply, 0)
        return made

    def _read(self, reply: bytes, number: int) -> Any:
        """The body of a reply.

        Raises:
            BabbleError: The server refuses the request.
        """
        try:
            replied, result, body = msgpack.decode(reply)
            kind, message = (body["kind"], body["message"]) if result == "error" else ("", "")
        except (DecodeError, ValueError, TypeError, KeyError) as error:
            raise ServerError(f"{self._url}: the reply is not of the protocol: {error}") from error
        if kind:
            raise KINDS.get(kind, ServerError)(message)
        if replied != number:
            raise ServerError(f"{self._url}: reply to {replied!r}, expected one to {number}")
        return body

    def _drop(self) -> None:
        if self._channel is not None:
            self._channel.abandon()
            self._channel = None

    def _attend(self) -> None:
        """Answers the server's pings while nothing else is asked, or it ends the connection."""
        while not self._closed.wait(ATTEND_S):
            with self._lock:
                if self._channel is None or self._lost:
                    continue
                try:
                    self._channel.answer_pings()
                except (OSError, BrokenChannelError) as error:
                    # The server keeps the session for a while only. If this fails, the next
                    # request tries again and reports.
                    with suppress(LimitError, ServerError):
                        self._drop()
                        self._heed(error)
                        self._resume(time.monotonic() + ASIDE_S)

    def close(self) -> None:
        """Ends the session on the server; calling it again is harmless."""
        if self._closed.is_set():
            return
        self._closed.set()
        if os.getpid() != self._process:
            self._drop()
            return
        with self._lock:
            channel, self._channel = self._channel, None
        if channel is not None:
            deadline = time.monotonic() + ASIDE_S
            with suppress(OSError, BrokenChannelError):
                channel.send(msgpack.encode([self._last + 1, "close", {}]), deadline)
                channel.receive(deadline)
            channel.close(deadline)
