"""Sessions of remote environments: broken connections, clients and servers that are gone."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from comparing import assert_same, drawn_actions
from processes import PATIENCE_S, forking, in_fork
from serving import Relay, served
from soak import soak
from websockets.sync.client import connect

from gym_babble.envs import BabbleReachEnv, BabbleReachVectorEnv
from gym_babble.errors import (
    LimitError,
    ServerError,
    ServerTimeoutError,
    SessionLostError,
)
from gym_babble.remote import RemoteEnv, RemoteVectorEnv, session

FIRST_OF = {"reach": "BabbleReach-v0", "grasp": "BabbleGrasp-v0"}
ACTION = np.array([0.3, -0.2], np.float32)


@pytest.fixture(scope="module")
def server():
    with served("--resume-seconds", 30) as server:
        yield server


@pytest.fixture(autouse=True)
def _soon(monkeypatch):
    """Nobody waits long between two tries."""
    monkeypatch.setattr(session, "RETRY_S", 0.02)


def until(condition):
    """Waits until something is true."""
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


# Broken connections.


def cut_each(k, going_up, share):
    """Breaks the connection at each k-th piece of data one way, after a share of its bytes."""
    seen = 0

    def cut(up, size):
        nonlocal seen
        if up is not going_up:
            return None
        seen += 1
        return int(share * size) if seen % k == 0 else None

    return cut


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0], ids=["none", "half", "all"])
@pytest.mark.parametrize("going_up", [True, False], ids=["request", "reply"])
def test_an_episode_goes_on_where_the_connection_broke(server, going_up, share):
    # A request that was executed and whose reply is lost would step twice.
    actions = drawn_actions(BabbleReachVectorEnv(3).action_space, 60, 0)
    local = BabbleReachVectorEnv(3, autoreset_mode="SameStep", max_episode_steps=17)
    with Relay(server.port, cut_each(4, going_up, share)) as relay:
        remote = RemoteVectorEnv(
            num_envs=3, url=relay.url, autoreset_mode="SameStep", max_episode_steps=17
        )
        assert_same(remote.reset(seed=1), local.reset(seed=1))
        for action in actions:
            assert_same(remote.step(action), local.step(action))
        assert remote.call("state_hash") == local.call("state_hash")
        assert relay.breaks >= 10
        assert relay.connections >= 10
        remote.close()


def test_a_connection_that_breaks_while_nobody_asks_is_made_again(server, monkeypatch):
    monkeypatch.setattr(session, "ATTEND_S", 0.02)
    with Relay(server.port) as relay:
        env = RemoteEnv(url=relay.url)
        env.reset(seed=0)
        relay.break_all()
        until(lambda: relay.connections == 2)
        local = BabbleReachEnv()
        local.reset(seed=0)
        assert_same(env.step(ACTION), local.step(ACTION))
        assert relay.connections == 2
        env.close()


def test_pings_are_answered_while_nobody_asks(monkeypatch):
    # A client that trains for minutes between two steps keeps its connection.
    monkeypatch.setattr(session, "ATTEND_S", 0.02)
    with served("--ping-seconds", 0.5) as server, Relay(server.port) as relay:
        pings = []
        relay.cut = lambda up, size: pings.append((up, size))
        env = RemoteEnv(url=relay.url)
        env.reset(seed=0)
        pings.clear()
        until(lambda: len(pings) > 8)  # Twice as many as the server lets go unanswered.
        env.step(ACTION)
        assert relay.connections == 1
        env.close()


def test_after_ctrl_c_the_late_reply_is_not_taken_for_the_next_one(server, monkeypatch):
    env, local = RemoteEnv(url=server.url), BabbleReachEnv()
    for each in (env, local):
        each.reset(seed=0)
    channel = type(env._batch._session._channel)

    def interrupted(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(channel, "receive", interrupted)
        with pytest.raises(KeyboardInterrupt):
            env.step(ACTION)
    local.step(ACTION)  # The server has executed it, or does so before the session is resumed.
    assert_same(env.step(-ACTION), local.step(-ACTION))
    env.close()


# Servers that are gone, slow or strange.


def test_without_a_server_the_error_says_how_to_start_one():
    with pytest.raises(ServerError, match="gym-babble serve") as caught:
        RemoteEnv(url="ws://127.0.0.1:9")
    assert isinstance(caught.value, ConnectionError)


def test_a_restarted_server_says_that_the_session_is_lost():
    with served() as server:
        env = RemoteEnv(url=server.url)
        env.reset(seed=0)
        server.process.kill()
        server.process.wait(PATIENCE_S)
    with served(port=server.port):
        with pytest.raises(SessionLostError, match="make a new environment") as caught:
            env.step(ACTION)
        assert isinstance(caught.value, ConnectionError)
        with pytest.raises(SessionLostError):
            env.reset()
        env.close()
        again = RemoteEnv(url=server.url)
        again.reset(seed=0)
        again.close()


def test_a_killed_server_is_told_after_the_timeout():
    with served() as server:
        env = RemoteEnv(url=server.url, timeout=0.5)
        env.reset(seed=0)
        server.process.kill()
        server.process.wait(PATIENCE_S)
    with pytest.raises(ServerError, match="cannot connect again"):
        env.step(ACTION)
    env.close()


def test_a_stopped_server_says_why():
    with served() as server:
        env = RemoteEnv(url=server.url)
        env.reset(seed=0)
        server.process.terminate()
        server.process.wait(PATIENCE_S)
        with pytest.raises(SessionLostError, match="stopped"):
            env.step(ACTION)


@pytest.mark.skipif(sys.platform != "linux", reason="waits for a stopped process")
def test_a_server_that_does_not_answer_in_time_has_its_own_error():
    with served() as server:
        env = RemoteEnv(url=server.url, timeout=0.3)
        env.reset(seed=0)
        server.process.send_signal(signal.SIGSTOP)
        os.waitid(os.P_PID, server.process.pid, os.WSTOPPED | os.WNOWAIT)
        try:
            with pytest.raises(ServerTimeoutError, match=r"'step' within 0.3 s") as caught:
                env.step(ACTION)
        finally:
            server.process.send_signal(signal.SIGCONT)
        assert isinstance(caught.value, TimeoutError)
        local = BabbleReachEnv()
        assert_same(env.reset(seed=3), local.reset(seed=3))
        assert_same(env.step(ACTION), local.step(ACTION))
        env.close()


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"\x00\xff" * 40,
        b"HTTP/1.1 404 Not Found\r\ncontent-length: 4\r\n\r\nnope",
        b"HTTP/1.1 200 OK\r\ncontent-length: 0\r\n\r\n",
        b"HTTP/1.1 101 Switching Protocols\r\n\r\n",
    ],
    ids=["nothing", "noise", "404", "200", "no handshake"],
)
def test_what_is_no_server_of_ours_is_told(answer):
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def respond():
            client, _ = listener.accept()
            with client:
                client.recv(4096)
                client.sendall(answer)

        thread = threading.Thread(target=respond)
        thread.start()
        url = f"ws://127.0.0.1:{listener.getsockname()[1]}"
        with pytest.raises(ServerError, match=re.escape(url)):
            RemoteEnv(url=url, timeout=5)
        thread.join()


def test_a_session_that_another_client_took_is_lost(server):
    env = RemoteEnv(url=server.url)
    env.reset(seed=0)
    thief = session.Session.__new__(session.Session)
    vars(thief).update(vars(env._batch._session), _channel=None)
    thief._resume(time.monotonic() + PATIENCE_S)
    with pytest.raises(SessionLostError, match="another client"):
        env.step(ACTION)
    thief._drop()


def test_idle_sessions_end_and_the_client_is_told():
    with served("--idle-seconds", 0.2, "--ping-seconds", 0.1) as server:
        env = RemoteEnv(url=server.url)
        env.reset(seed=0)
        until(lambda: server.metric("gym_babble_sessions ") == 0)
        with pytest.raises(SessionLostError, match="no request came"):
            env.step(ACTION)


# Tokens and limits.


def test_a_token_opens_the_server():
    environment = {**os.environ, "GYM_BABBLE_TOKEN": "a-token-of-some-length-0123456789"}
    with served(env=environment) as server:
        for token in (None, "another-token-of-some-length-012345"):
            with pytest.raises(ServerError, match="401"):
                RemoteEnv(url=server.url, token=token)
        env = RemoteEnv(url=server.url, token=environment["GYM_BABBLE_TOKEN"])
        env.reset(seed=0)
        env.close()


def test_limits_of_the_server_are_told():
    with served("--sessions", 1, "--message-bytes", 4_000) as server:
        env = RemoteVectorEnv(num_envs=2, url=server.url)
        env.reset(seed=0)
        with pytest.raises(LimitError, match="at most 1"):
            RemoteEnv(url=server.url)
        with pytest.raises(LimitError, match="at most 4000"):
            env.set_state([bytes(5_000)] * 2)
        env.reset(seed=1)  # The session goes on.
        env.close()
        RemoteEnv(url=server.url).close()


# Clients that are gone.

CLIENT = """
import sys
from gym_babble.remote import RemoteVectorEnv
envs = RemoteVectorEnv(num_envs=3, url=sys.argv[1])
envs.reset(seed=0)
print("ready", flush=True)
while True:
    envs.step(envs.action_space.sample())
"""


def test_a_killed_client_frees_its_session():
    with served("--resume-seconds", 0.1) as server:
        with subprocess.Popen(
            [sys.executable, "-c", CLIENT, server.url], stdout=subprocess.PIPE, text=True
        ) as client:
            assert client.stdout.readline() == "ready\n"
            assert server.metric("gym_babble_environments ") == 3
            client.kill()
        until(lambda: server.metric("gym_babble_environments ") == 0)
        assert server.metric("gym_babble_sessions ") == 0


def test_forgotten_environments_free_their_sessions():
    with served() as server:
        env = RemoteEnv(url=server.url)
        env.reset(seed=0)
        del env
        until(lambda: server.metric("gym_babble_sessions ") == 0)
        program = (
            "import sys; from gym_babble.remote import RemoteEnv; "
            "env = RemoteEnv(url=sys.argv[1]); env.reset()"
        )
        subprocess.run([sys.executable, "-c", program, server.url], check=True)
        until(lambda: server.metric("gym_babble_sessions ") == 0)


def test_a_forked_process_does_not_touch_its_parents_session(server):
    env, local = RemoteEnv(url=server.url), BabbleReachEnv()
    for each in (env, local):
        each.reset(seed=0)

    def in_child():
        try:
            env.step(ACTION)
        except ServerError as error:
            told = str(error)
        env.close()
        return told.encode()

    with forking():
        assert b"make one in each process" in in_fork(in_child)
    assert_same(env.step(ACTION), local.step(ACTION))
    env.close()


def test_garbage_of_others_disturbs_no_session(server):
    env, local = RemoteEnv(url=server.url), BabbleReachEnv()
    assert_same(env.reset(seed=0), local.reset(seed=0))
    stopped = threading.Event()

    def disturb():
        random = np.random.default_rng(0)
        while not stopped.is_set():
            with socket.create_connection(("127.0.0.1", server.port)) as raw:
                raw.sendall(random.bytes(500))
            with connect(f"{server.url}/ws", subprotocols=["gym-babble.v1"]) as other:
                for _ in range(5):
                    other.send(random.bytes(100))
                    other.recv()

    thread = threading.Thread(target=disturb)
    thread.start()
    for action in drawn_actions(env.action_space, 300, 0):
        ours, theirs = env.step(action), local.step(action)
        assert_same(ours, theirs)
        if ours[2] or ours[3]:
            assert_same(env.reset(), local.reset())
    stopped.set()
    thread.join(PATIENCE_S)
    env.close()


# Nothing is left behind.


def resources(server):
    """What a server's process has: memory [kB], threads, descriptors."""
    process = Path(f"/proc/{server.process.pid}")
    status = (process / "status").read_text()
    numbers = [int(re.search(rf"{name}:\s+(\d+)", status)[1]) for name in ("VmRSS", "Threads")]
    return np.array([*numbers, len(list((process / "fd").iterdir()))])


def left_behind(server, connects):
    """What a server's process has more of after many clients."""

    def clients(n):
        for k in range(n):
            env = RemoteVectorEnv(num_envs=2, url=server.url)
            env.reset(seed=k)
            env.step(env.action_space.sample())
            if k % 2:
                env.close()
            else:
                env._batch._session._drop()  # Without a word.
                env.close()
        until(lambda: server.metric("gym_babble_sessions ") == 0)

    clients(20)
    before = resources(server)
    clients(connects)
    until(lambda: (resources(server) - before)[2] <= 0)  # Sockets close a little later.
    return resources(server) - before


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize("connects", [50, pytest.param(1_000, marks=pytest.mark.slow)])
def test_connects_leave_nothing_behind(connects):
    mine = len(os.listdir("/proc/self/fd")), threading.active_count()  # noqa: PTH208
    with served("--resume-seconds", 0.05, "--sessions-per-second", 10_000) as server:
        kilobytes, threads, _ = left_behind(server, connects)
    print(f"after {connects} connects: {kilobytes} kB and {threads} threads more")
    assert threads <= 2
    assert kilobytes < 4_096
    until(lambda: threading.active_count() <= mine[1])
    assert len(os.listdir("/proc/self/fd")) <= mine[0]  # noqa: PTH208


# Full load.


def play_at_random(task, url, steps):
    """The soak of local batches, in remote ones."""

    def make(num_envs, **form):
        env_id = "BabbleGraspFull-v0" if form.get("region") == "full" else FIRST_OF[task]
        return RemoteVectorEnv(env_id, num_envs, url=url, **form)

    return soak(task, steps, rounds=1, num_envs=8, make=make)


@pytest.mark.parametrize("task", ["reach", pytest.param("grasp", marks=pytest.mark.slow)])
def test_random_play_finds_no_fault(task, server):
    tally = play_at_random(task, server.url, 1_500)
    assert tally.steps >= 1_500
    assert tally.refused >= 10


@pytest.mark.soak
@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_ten_minutes_at_full_load():
    end = time.monotonic() + 600
    steps = dict.fromkeys(FIRST_OF, 0)
    faults = []

    def client(task):
        try:
            while time.monotonic() < end:
                steps[task] += play_at_random(task, server.url, 20_000).steps
        except BaseException as fault:
            faults.append(fault)
            raise

    with served("--request-seconds", 60) as server:
        before = resources(server)
        threads = [threading.Thread(target=client, args=(task,)) for task in 2 * list(FIRST_OF)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        until(lambda: server.metric("gym_babble_sessions ") == 0)
        until(lambda: (resources(server) - before)[2] <= 0)
        more = resources(server) - before
    print(steps, f"more at the end: {more[0]} kB, {more[1]} threads, {more[2]} descriptors")
    assert not faults
    assert more[0] < 65_536
