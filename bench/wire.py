"""Round trips over loopback: clients of our server, and of others that do nothing.

Client and server run on a core each, where there are two. CPU time is that of both processes.
It is imported in the peers' virtual environments too, where only NumPy is sure to be there.
"""

from __future__ import annotations

import contextlib
import http.client
import os
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.clock import WARM_UP_S

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bench.clock import Row

FLOATS = 64
"""Numbers in an observation of an environment that does nothing."""
ACTION = [0.1, 0.1]
START_S = 60.0
PROGRAM = Path(__file__).resolve().parent.parent / "target" / "release" / "gym-babble-server"
TICK = os.sysconf("SC_CLK_TCK")


@contextlib.contextmanager
def serving(command: list[str], **options: Any) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A server on a core of its own, and the first line that it prints."""
    first, *others = sorted(os.sched_getaffinity(0))
    own = {others[-1]} if others else {first}
    server = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: os.sched_setaffinity(0, own),  # noqa: PLW1509 - one thread so far
        **options,
    )
    os.sched_setaffinity(0, {first})
    try:
        assert server.stdout is not None
        line = server.stdout.readline().strip()
        if not line:
            raise RuntimeError(f"the server ended with status {server.wait(START_S)}")
        yield server, line
    finally:
        server.kill()
        server.communicate()


def trips(
    ask: Callable[[], object],
    server: int,
    seconds: float,
    *,
    units: int = 1,
    restart: Callable[[], object] | None = None,
    calls: int = 1_000_000_000,
) -> Row:
    """CPU and clock time of a unit [µs], and the median and the 99th percentile of round trips.

    Args:
        ask: A round trip.
        server: The server's process.
        seconds: Duration of the measurement.
        units: Units of work in one round trip.
        restart: Called before every `calls` round trips, outside the measured time.
        calls: See `restart`.
    """
    _ask(ask, WARM_UP_S, restart, calls)
    times, cpu = _ask(ask, seconds, restart, calls, server)
    each = 1e6 / (len(times) * units)
    p50, p99 = np.percentile(times, [50, 99])
    return {
        "cpu_us": cpu * each,
        "clock_us": sum(times) * each,
        "p50_us": float(p50) * 1e6,
        "p99_us": float(p99) * 1e6,
    }


def _ask(
    ask: Callable[[], object],
    seconds: float,
    restart: Callable[[], object] | None,
    calls: int,
    server: int | None = None,
) -> tuple[list[float], float]:
    """Times of round trips, and processor time of both processes [s]."""

    def used() -> float:
        return time.process_time() + (0.0 if server is None else cpu_of(server))

    times: list[float] = []
    cpu = clock = 0.0
    while clock < seconds:
        if restart is not None:
            restart()
        before, now = used(), time.perf_counter()
        for _ in range(calls):
            ask()
            then, now = now, time.perf_counter()
            times.append(now - then)
            clock += now - then
            if clock >= seconds:
                break
        cpu += used() - before
    return times, cpu


def cpu_of(process: int) -> float:
    """Seconds of processor time of another process and its threads."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def free_port() -> int:
    """A port that nobody listens on now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port


def program() -> list[str]:
    """The command that starts our server."""
    return [str(PROGRAM), "--port", "0"]


def of_own(name: str, *arguments: str) -> list[str]:
    """The command that starts a server of bench.servers in this Python."""
    return [sys.executable, "-m", "bench.servers", name, *arguments]


def echo(seconds: float, *, size: int) -> Row:
    """Bytes to a plain TCP socket and back: no protocol can be faster."""
    message = b"x" * size
    with (
        serving(of_own("echo")) as (server, port),
        socket.create_connection(("127.0.0.1", int(port))) as link,
    ):
        link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

        def ask() -> None:
            link.sendall(message)
            got = 0
            while got < size:
                got += len(link.recv(65_536))

        return trips(ask, server.pid, seconds)


def openenv(seconds: float) -> Row:
    """OpenEnv's client and its own server of an environment that does nothing."""
    from openenv.core import GenericEnvClient

    port = free_port()
    with serving(of_own("openenv", str(port))) as (server, url):
        _wait(lambda: _is_healthy(port))
        with GenericEnvClient(base_url=url).sync() as client:
            client.reset()
            return trips(lambda: client.step({"values": ACTION}), server.pid, seconds)


def openenv_ours(seconds: float) -> Row:
    """OpenEnv's client and our server of `BabbleReach-v0`."""
    from openenv.core import GenericEnvClient

    with serving(program()) as (server, line):
        url = f"http://{line.rpartition(' ')[2]}"
        with GenericEnvClient(base_url=url).sync() as client:
            client.reset()

            def ask() -> None:
                if client.step({"action": ACTION}).done:
                    client.reset()

            return trips(ask, server.pid, seconds)


def _is_healthy(port: int) -> bool:
    link = http.client.HTTPConnection("127.0.0.1", port, timeout=1)
    try:
        link.request("GET", "/health")
        return link.getresponse().status == 200
    except OSError:
        return False
    finally:
        link.close()


def dm_env_rpc(seconds: float) -> Row:
    """dm_env_rpc's client and a server on its library that does nothing."""
    import grpc
    from dm_env_rpc.v1 import connection, dm_env_rpc_pb2, tensor_utils

    action = np.asarray(ACTION, np.float32)
    credentials = grpc.local_channel_credentials()
    with (
        serving(of_own("dm_env_rpc")) as (server, port),
        connection.create_secure_channel_and_connect(f"localhost:{port}", credentials) as link,
    ):

        def ask() -> None:
            request = dm_env_rpc_pb2.StepRequest(requested_observations=[1, 2])
            request.actions[1].CopyFrom(tensor_utils.pack_tensor(action))
            tensor_utils.unpack_tensor(link.send(request).observations[1])

        return trips(ask, server.pid, seconds)


def rlmesh(seconds: float) -> Row:
    """RLMesh's client and server of an environment that does nothing."""
    from rlmesh.numpy import RemoteEnv

    action = np.asarray(ACTION, np.float32)
    port = free_port()
    with serving(of_own("rlmesh", str(port))) as (server, address):
        _wait(lambda: _listens(port))
        env = RemoteEnv(address)
        env.reset(seed=0)
        return trips(lambda: env.step(action), server.pid, seconds)


def _wait(is_so: Callable[[], bool]) -> None:
    end = time.perf_counter() + START_S
    while not is_so():
        if time.perf_counter() > end:
            raise RuntimeError(f"the server is not there after {START_S:g} s")
        time.sleep(0.05)


def _listens(port: int) -> bool:
    try:
        socket.create_connection(("127.0.0.1", port), timeout=1).close()
    except OSError:
        return False
    return True
