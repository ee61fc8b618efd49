"""Round trips to our server over loopback, from the package's own clients."""

from __future__ import annotations

import threading
import time
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.ours import ACTIONS, HELD_STEPS, HOLDING, copies, held, playing
from bench.wire import cpu_of, program, serving, trips
from gym_babble.remote import RemoteEnv, RemoteVectorEnv

if TYPE_CHECKING:
    from bench.clock import Row


def url_of(line: str) -> str:
    """Where a server listens, from its first line."""
    return f"ws://{line.rpartition(' ')[2]}"


def single(seconds: float, *, env_id: str) -> Row:
    """A step of `RemoteEnv`, random actions, resets included."""
    with serving(program()) as (server, line):
        env = RemoteEnv(env_id, url=url_of(line))
        env.reset(seed=0)
        env.action_space.seed(0)
        actions = cycle([env.action_space.sample() for _ in range(ACTIONS)])

        def ask() -> None:
            _, _, terminated, truncated, _ = env.step(next(actions))
            if terminated or truncated:
                env.reset()

        row = trips(ask, server.pid, seconds)
        env.close()
        return row


def batch(seconds: float, *, n: int) -> Row:
    """A step of one environment of a batch that reaches, random actions, autoresets included."""
    env_id = "BabbleReach-v0"
    states = playing(env_id)
    with serving(program()) as (server, line):
        envs = RemoteVectorEnv(env_id, n, url=url_of(line), threads=1)
        envs.reset(seed=0)
        envs.set_state(copies(states, n))
        drawn = np.random.default_rng(0).uniform(-1.0, 1.0, (ACTIONS, n, 2))
        actions = cycle(drawn.astype(np.float32))
        row = trips(lambda: envs.step(next(actions)), server.pid, seconds, units=n)
        envs.close()
        return row


def held_batch(seconds: float, *, n: int, threads: int) -> Row:
    """A step of one environment of a batch in which every hand holds its object."""
    states, moves = held()
    moves = moves[:, np.arange(n) % len(states)]
    with serving(program()) as (server, line):
        envs = RemoteVectorEnv("BabbleGrasp-v0", n, url=url_of(line), threads=threads, **HOLDING)
        envs.reset(seed=0)
        actions = iter(moves)

        def restart() -> None:
            nonlocal actions
            envs.set_state(copies(states, n))
            actions = iter(moves)

        row = trips(
            lambda: envs.step(next(actions)),
            server.pid,
            seconds,
            units=n,
            restart=restart,
            calls=HELD_STEPS,
        )
        envs.close()
        return row


def sessions(seconds: float, *, n: int) -> Row:
    """Sessions at once, each with a client in a thread: how far their rates lie apart.

    And the server's processor time of a step [µs].
    """
    with serving(program()) as (server, line):
        envs = [RemoteEnv("BabbleReach-v0", url=url_of(line)) for _ in range(n)]
        counts = [0] * n
        begin, end = threading.Barrier(n + 1), threading.Event()

        def play(i: int, env: Any) -> None:
            env.reset(seed=i)
            action = np.zeros(env.action_space.shape, np.float32)
            begin.wait()
            while not end.is_set():
                _, _, terminated, truncated, _ = env.step(action)
                counts[i] += 1
                if terminated or truncated:
                    env.reset()

        players = [threading.Thread(target=play, args=each) for each in enumerate(envs)]
        for player in players:
            player.start()
        begin.wait()
        before = cpu_of(server.pid)
        time.sleep(seconds)
        end.set()
        for player in players:
            player.join()
        cpu = cpu_of(server.pid) - before
        for env in envs:
            env.close()
        mean = sum(counts) / n
        return {
            "clock_us": 1e6 * seconds / sum(counts),
            "server_us": 1e6 * cpu / sum(counts),
            "slowest": min(counts) / mean,
            "fastest": max(counts) / mean,
        }
