"""Measurements of this package's environments."""

from __future__ import annotations

from functools import cache
from itertools import cycle, islice
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec

import gym_babble
from bench.clock import memory_kib, spin
from bench.peers import spin_single
from gym_babble.envs import BabbleGraspVectorEnv

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from bench.clock import Row

POOL = 32
"""Number of different episodes; larger batches contain copies of them."""
EPISODE_STEPS = 240
ACTIONS = 32
"""Number of random actions, used in turn."""

HOLDING: dict[str, Any] = {
    "obs": "goal",  # These episodes go on when the object is held.
    "reward": "sparse",
    "control": "posture",
    "max_episode_steps": 1_000_000,
}
HELD_STEPS = 40
"""Steps between restarts from the held states: two seconds."""
TARGET_STEPS = 10
"""Steps for each random posture of the arm."""


def single(seconds: float, *, env_id: str) -> Row:
    """A step with `gymnasium.make`, random actions, resets included."""
    return spin_single(gymnasium.make(env_id), seconds)


def batch(seconds: float, *, env_id: str, n: int, threads: int) -> Row:
    """A step of one environment of a batch, random actions, autoresets included.

    The episodes differ in age, as in a batch that has run for a long time.
    """
    envs: Any = gymnasium.make_vec(env_id, num_envs=n, threads=threads)
    envs.reset(seed=0)
    envs.set_state(copies(playing(env_id), n))
    random = np.random.default_rng(0)
    drawn = random.uniform(-1.0, 1.0, (ACTIONS, *envs.action_space.shape)).astype(np.float32)
    actions, steps_a_call = cycle(drawn), max(1, ACTIONS // n)

    def steps() -> None:
        for action in islice(actions, steps_a_call):
            envs.step(action)

    return spin(steps, n * steps_a_call, seconds)


@cache
def playing(env_id: str) -> list[bytes]:
    """States of random play: the k-th of n after k / n of an episode."""
    envs: Any = gymnasium.make_vec(env_id, num_envs=POOL)
    envs.reset(seed=0)
    envs.action_space.seed(0)
    states: list[bytes] = []
    for step in range(EPISODE_STEPS):
        while len(states) < POOL and step >= len(states) * EPISODE_STEPS // POOL:
            states.append(envs.of_one(len(states), "get_state")())
        envs.step(envs.action_space.sample())
    return states


def copies(states: Sequence[bytes], n: int) -> list[bytes]:
    """The states, repeated as often as needed."""
    return [states[i % len(states)] for i in range(n)]


@cache
def held() -> tuple[list[bytes], NDArray[np.float32]]:
    """States with the object held, and actions (steps, states, 4) that keep it held.

    The hand stays closed while the arm moves from one random posture to the next. The same state
    and actions give the same bits, so every repetition holds the object too.
    """
    envs = BabbleGraspVectorEnv(POOL, **HOLDING)
    observation, info = envs.reset(seed=0)
    agent, grasping = gym_babble.Scripted(envs), None
    for _ in range(EPISODE_STEPS):
        actions, grasping = agent.predict(observation, grasping)
        observation, _, _, _, info = envs.step(actions)
    began, states = info["held"], envs.get_state()
    arms = np.random.default_rng(0).uniform(-1.0, 1.0, (HELD_STEPS // TARGET_STEPS, POOL, 2))
    hands = np.broadcast_to(actions[:, 2:], (HELD_STEPS, POOL, 2))
    moves = np.concatenate([arms.repeat(TARGET_STEPS, axis=0), hands], axis=2).astype(np.float32)
    for action in moves:
        _, _, _, _, info = envs.step(action)
    kept = np.flatnonzero(began & ~info["outcome"]["lost"])
    if len(kept) < POOL // 2:
        raise RuntimeError(f"only {len(kept)} of {POOL} hands held their object")
    return [states[i] for i in kept], moves[:, kept]


def held_single(seconds: float) -> Row:
    """A step with `gymnasium.make` with the object held."""
    spec = EnvSpec(
        "BabbleGraspHeld-v0", entry_point="gym_babble.envs:BabbleGraspEnv", kwargs=HOLDING
    )
    env = gymnasium.make(spec)
    env.reset(seed=0)
    states, moves = held()
    actions = iter(moves[:, 0])

    def restart() -> None:
        nonlocal actions
        env.unwrapped.set_state(states[0])  # type: ignore[attr-defined]
        actions = iter(moves[:, 0])

    return spin(lambda: env.step(next(actions)), 1, seconds, restart=restart, calls=HELD_STEPS)


def held_batch(seconds: float, *, n: int, threads: int) -> Row:
    """A step of one environment of a batch in which every hand holds its object."""
    envs = BabbleGraspVectorEnv(n, threads=threads, **HOLDING)
    envs.reset(seed=0)
    states, moves = held()
    moves = moves[:, np.arange(n) % len(states)]
    actions = iter(moves)

    def restart() -> None:
        nonlocal actions
        envs.set_state(copies(states, n))
        actions = iter(moves)

    return spin(lambda: envs.step(next(actions)), n, seconds, restart=restart, calls=HELD_STEPS)


def reset(seconds: float, *, env_id: str) -> Row:
    """A reset with a given case, with `gymnasium.make`."""
    env: Any = gymnasium.make(env_id)
    env.reset(seed=0)
    options = {"scenario": env.unwrapped.scenario}
    return spin(lambda: env.reset(options=options), 1, seconds)


def picture(seconds: float, *, env_id: str, camera: str, pixels: int) -> Row:
    """A call of `env.render()`, a few steps into an episode."""
    env: Any = gymnasium.make(
        env_id, render_mode="rgb_array", camera=camera, width=pixels, height=pixels
    )
    env.reset(seed=0)
    env.action_space.seed(0)
    for _ in range(TARGET_STEPS):
        env.step(env.action_space.sample())
    return spin(env.render, 1, seconds)


def memory(seconds: float, *, env_id: str, n: int) -> Row:
    """Memory of a batch after its first steps, for each environment [KiB]."""
    del seconds
    states = playing(env_id)
    random = np.random.default_rng(0)
    before = memory_kib()
    envs: Any = gymnasium.make_vec(env_id, num_envs=n)
    envs.reset(seed=0)
    envs.set_state(copies(states, n))
    for _ in range(2):
        envs.step(random.uniform(-1.0, 1.0, envs.action_space.shape).astype(np.float32))
    return {"kib": (memory_kib() - before) / n}


def memory_held(seconds: float, *, n: int) -> Row:
    """Memory of a batch in which every hand holds its object, for each environment [KiB]."""
    del seconds
    states, moves = held()
    before = memory_kib()
    envs = BabbleGraspVectorEnv(n, **HOLDING)
    envs.reset(seed=0)
    envs.set_state(copies(states, n))
    for action in moves[:2]:
        envs.step(action[np.arange(n) % len(states)])
    return {"kib": (memory_kib() - before) / n}
