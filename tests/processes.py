"""Functions run in another process, which may hang: then the test fails."""

from __future__ import annotations

import multiprocessing
import os
import warnings
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from multiprocessing.connection import Connection

START_METHODS = ("fork", "forkserver", "spawn")
PATIENCE_S = 60
"""Longer than any child takes on a busy machine."""


@contextmanager
def forking() -> Iterator[None]:
    """Python 3.12 and newer warn of forks of a process with threads; that they work is the test."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        yield


def in_process(start_method: str, function: Callable[..., Any], *arguments: Any) -> Any:
    """What a function returns in a new process, in which it also comes to an end."""
    context: Any = multiprocessing.get_context(start_method)
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_send, args=(sender, function, arguments))
    with forking():
        child.start()
    sender.close()
    try:
        assert receiver.poll(PATIENCE_S), f"{start_method}: no answer"
        answer = receiver.recv()
        child.join(PATIENCE_S)
        assert child.exitcode == 0, f"{start_method}: exit code {child.exitcode}"
    finally:
        if child.is_alive():
            child.kill()
        child.join()
    return answer


def _send(sender: Connection, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    sender.send(function(*arguments))


def in_fork(function: Callable[[], bytes]) -> bytes:
    """The bytes that a function returns in a bare fork of this process."""
    with forking():
        reading, writing = os.pipe()
        child = os.fork()
    if child == 0:
        code = 1
        try:
            os.write(writing, function())
            code = 0
        finally:
            os._exit(code)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        answer = pipe.read()
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    return answer
