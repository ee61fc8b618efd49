"""The registered environments: one table and one loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import gymnasium

__all__ = ["ENVIRONMENTS", "Registered", "register_all"]


@dataclass(frozen=True)
class Registered:
    """One row of the table."""

    id: str
    task: str
    obs: str
    control: str
    reward: str
    max_episode_steps: int | None
    """Time limit; none in `pattern` control, where each episode ends by itself after one step."""
    reward_threshold: float
    """Mean return at which the task counts as solved: success in nine cases of ten (an oracle that
    plays whole movements has a mean return of 2.66, 1, −168 and 1)."""

    @property
    def kwargs(self) -> dict[str, Any]:
        """The choices this id stands for; each can be overridden in `make`."""
        return {"obs": self.obs, "control": self.control, "reward": self.reward}


ENTRY_POINTS = {"reach": ("BabbleReachEnv", "BabbleReachVectorEnv")}
"""Single and vector environment of each task, in `gym_babble.envs`."""

ENVIRONMENTS = (
    Registered("BabbleReach-v0", "reach", "senses", "delta_posture", "progress", 240, 2.3),
    Registered("BabbleReachSparse-v0", "reach", "senses", "delta_posture", "sparse", 240, 0.9),
    Registered("BabbleReachGoal-v0", "reach", "goal", "delta_posture", "sparse", 240, -120.0),
    Registered("BabbleReachPattern-v0", "reach", "senses", "pattern", "sparse", None, 0.9),
)


def register_all() -> None:
    """Registers every environment with Gymnasium; again is harmless."""
    for row in ENVIRONMENTS:
        if row.id in gymnasium.registry:
            continue
        single, vector = ENTRY_POINTS[row.task]
        gymnasium.register(
            id=row.id,
            entry_point=f"gym_babble.envs:{single}",
            vector_entry_point=f"gym_babble.envs:{vector}",
            reward_threshold=row.reward_threshold,
            max_episode_steps=row.max_episode_steps,
            kwargs=row.kwargs,
        )
