"""What is installed, whether the core computes what it should, and how fast it is."""

from __future__ import annotations

import os
import platform
from hashlib import blake2b
from importlib.metadata import PackageNotFoundError, version
from time import perf_counter
from typing import Any

import gymnasium
import numpy as np

from gym_babble._core import __version__, debug_build
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv

__all__ = ["EXTRAS", "STATE_HASH", "examine", "state_hash", "versions"]

EXTRAS = {
    "sb3": ("stable-baselines3", "torch"),
    "figures": ("matplotlib", "pillow"),
    "human": ("pygame-ce",),
    "video": ("moviepy",),
}
"""The extras, and the packages that each brings."""

STATE_HASH = 0x78FF_8A0A_4D1D_3A62
"""`state_hash()` on every platform."""


def versions() -> dict[str, str | None]:
    """Versions of what this package runs on, and of the extras; None where one is missing."""
    packages = ("gymnasium", "numpy", *(name for extra in EXTRAS.values() for name in extra))
    found = {"gym-babble": __version__, "python": platform.python_version()}
    return {**found, **{name: _version(name) for name in packages}}


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def state_hash() -> int:
    """Hash of both tasks' states after 20 steps from seed 0; it must not depend on the machine."""
    digest = blake2b(digest_size=8)
    for env in (BabbleReachEnv(), BabbleGraspEnv(control="posture")):
        env.reset(seed=0)
        width = len(env.action_space.sample())
        for step in range(20):
            action = np.array([0.1 * (step % 7) - 0.3, *[0.25] * (width - 1)], np.float32)
            env.step(action)
        digest.update(env.state_hash().to_bytes(8, "little"))
    return int.from_bytes(digest.digest(), "little")


def examine() -> dict[str, Any]:
    """All of it, in JSON's types."""
    found = versions()
    known = state_hash()
    return {
        "versions": found,
        "extras": {
            extra: all(found[name] is not None for name in names) for extra, names in EXTRAS.items()
        },
        "build": "debug" if debug_build else "release",
        "platform": f"{platform.system()} {platform.machine()}",
        "threads": os.cpu_count() or 1,
        "state_hash": f"{known:016x}",
        "state_hash_expected": f"{STATE_HASH:016x}",
        "same_bits": known == STATE_HASH,
        "step_us": _time_single(),
        "step_in_batch_of_64_us": _time_batch(),
    }


def _time_single(steps: int = 4_000) -> float:
    """Clock time of a step through `gymnasium.make`, resets included [µs]."""
    env = gymnasium.make("BabbleReach-v0")
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(16)]
    env.reset(seed=0)
    began = perf_counter()
    for step in range(steps):
        _, _, terminated, truncated, _ = env.step(actions[step % 16])
        if terminated or truncated:
            env.reset()
    return 1e6 * (perf_counter() - began) / steps


def _time_batch(steps: int = 400, num_envs: int = 64) -> float:
    """Clock time of a step of one of 64 environments through `gymnasium.make_vec` [µs]."""
    envs = gymnasium.make_vec("BabbleReach-v0", num_envs=num_envs)
    envs.action_space.seed(0)
    actions = [envs.action_space.sample() for _ in range(16)]
    envs.reset(seed=0)
    began = perf_counter()
    for step in range(steps):
        envs.step(actions[step % 16])
    seconds = perf_counter() - began
    envs.close()
    return 1e6 * seconds / (steps * num_envs)
