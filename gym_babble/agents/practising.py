"""Episodes that an agent of Python practises in while it learns."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.envs import BabbleEnv

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble.envs.interface import Interface

__all__ = ["LEARNS_IN", "Practice", "stream"]

LEARNS_IN: dict[str, dict[str, Any]] = {
    "reach": {"control": "pattern", "reward": "sparse", "obs": "flat"},
    "grasp": {"obs": "flat"},
}
"""Options of the environment that an agent of Python learns in, by task; it acts in others too."""


def stream(seed: int, k: int) -> np.random.Generator:
    """The random numbers of trial k of a seed."""
    return np.random.default_rng([seed, k])


class Practice:
    """Episodes one after the other; the case of episode k depends on seed and k alone.

    Args:
        interface: Its task and config are those of the episodes.
        seed: Seed of the cases.
    """

    def __init__(self, interface: Interface, seed: int) -> None:
        task = interface.entry.name
        config = json.loads(interface.task.config())
        self._env = BabbleEnv(None, task=task, config=config, **LEARNS_IN[task])
        self._seed = seed

    def see(self, k: int) -> NDArray[np.float32]:
        """Flat senses (m,) at the beginning of episode k."""
        words = np.random.SeedSequence([self._seed, k]).generate_state(1, np.uint64)
        senses: NDArray[np.float32] = self._env.reset(seed=int(words[0]))[0]
        return senses

    def move(self, b1: float) -> float:
        """In reaching, makes the movement (b1, 1 − b1); its reward is 1 for success, else 0."""
        action = np.array([2.0 * b1 - 1.0, 1.0 - 2.0 * b1], np.float32)
        return float(self._env.step(action)[1])
