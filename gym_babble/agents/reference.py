"""Agents that need no learning: random, scripted and oracle movements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gym_babble import _core
from gym_babble.agents.movements import MovementAgent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble.agents.base import EnvLike

__all__ = ["Oracle", "RandomBabbling", "Scripted"]


class RandomBabbling(MovementAgent):
    """Babbles: b1 uniform in its range, b2 = 1 − b1."""

    def __init__(self, env: EnvLike = "BabbleReachPattern-v0", *, seed: int | None = None) -> None:
        super().__init__(env)
        self._random = np.random.default_rng(seed)

    def decide(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """Parameters (b1, b2) of movements (n, 2), for flat senses (n, 11)."""
        low, high = self._interface.quantities["b_range"].tolist()
        b1 = self._random.uniform(low, high, size=len(senses))
        return np.stack([b1, 1.0 - b1], axis=1)


class Scripted(MovementAgent):
    """Bulges towards the shoulder, where the arm folds away from the obstacle: |b1 − ½| = ¼."""

    def __init__(self, env: EnvLike = "BabbleReachPattern-v0") -> None:
        super().__init__(env)

    def decide(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """Parameters (b1, b2) of movements (n, 2), for flat senses (n, 11)."""
        return _core.scripted(self._interface.task, senses)


class Oracle(MovementAgent):
    """Simulates up to 99 values of b1 and takes the middle of the longest run that succeeds."""

    def __init__(self, env: EnvLike = "BabbleReachPattern-v0", *, threads: int = 1) -> None:
        super().__init__(env)
        self._threads = threads

    def decide(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """Parameters (b1, b2) of movements (n, 2), for flat senses (n, 11)."""
        return _core.oracle(self._interface.task, senses, self._threads)
