"""Measurements of other packages, and of environments that do nothing.

It is imported in each package's virtual environment, all of which have Gymnasium.
"""

from __future__ import annotations

import importlib
from itertools import cycle
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec

from bench.clock import spin

if TYPE_CHECKING:
    from bench.clock import Row

STEPS = 64
"""Number of random actions, used in turn, and of steps between readings of the clock."""
SENSES = spaces.Box(-1.0, 1.0, (64,), np.float32)
ACTION = spaces.Box(-1.0, 1.0, (2,), np.float32)


def single(seconds: float, *, env_id: str, package: str) -> Row:
    """A step with `gymnasium.make`, random actions, resets included."""
    importlib.import_module(package)  # It registers the id.
    return spin_single(gymnasium.make(env_id), seconds)


def spin_single(env: Any, seconds: float) -> Row:
    """A step of any single environment, random actions, resets included."""
    env.reset(seed=0)
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(STEPS)]

    def steps() -> None:
        for action in actions:
            _, _, terminated, truncated, _ = env.step(action)
            if terminated or truncated:
                env.reset()

    return spin(steps, STEPS, seconds)


def envpool(seconds: float, *, env_id: str, n: int, threads: int) -> Row:
    """A step of one environment of EnvPool's batch, random actions, autoresets included."""
    pool = importlib.import_module("envpool")
    envs = pool.make(env_id, env_type="gymnasium", num_envs=n, num_threads=threads, seed=0)
    envs.reset()
    low, high = envs.action_space.low, envs.action_space.high
    drawn = np.random.default_rng(0).uniform(low, high, (STEPS, n, *low.shape))
    actions = cycle(drawn)
    return spin(lambda: envs.step(next(actions)), n, seconds)


class Nothing(gymnasium.Env[Any, Any]):
    """A single environment that only creates the observation's array."""

    observation_space = SENSES
    action_space = ACTION

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Creates the array."""
        del seed, options
        return np.zeros(SENSES.shape, np.float32), {}

    def step(self, _: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Creates the array."""
        return np.zeros(SENSES.shape, np.float32), 0.0, False, False, {}


def floor_single(seconds: float) -> Row:
    """Cost of Gymnasium's own API."""
    return spin_single(gymnasium.make(EnvSpec("Nothing-v0", "bench.peers:Nothing")), seconds)


class Nothings(gymnasium.vector.VectorEnv[Any, Any, Any]):
    """A batch that only creates the arrays of a step."""

    def __init__(self, n: int) -> None:
        self.num_envs = n

    def step(self, _: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Creates the arrays."""
        n = self.num_envs
        ends = np.zeros(n, np.bool_), np.zeros(n, np.bool_)
        return np.zeros((n, *SENSES.shape), np.float32), np.zeros(n), *ends, {}


def floor_batch(seconds: float, *, n: int) -> Row:
    """Lower bound of any batch that returns new arrays."""
    envs, actions = Nothings(n), np.zeros((n, *ACTION.shape), np.float32)

    def steps() -> None:
        for _ in range(STEPS):
            envs.step(actions)

    return spin(steps, n * STEPS, seconds)
