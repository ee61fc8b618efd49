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
    """Time limit of Gymnasium's wrapper; none where the core's own decides: in `pattern` control an
    episode is one step, in grasping the limit depends on the region."""
    reward_threshold: float | None
    """Mean return at which the task counts as solved: success in nine cases of ten (an oracle that
    plays whole movements has a mean return of 2.66, 1, −168 and 1; a hand that goes straight to the
    object and closes has 5.8 and 1). None where no agent of ours solves it."""

    @property
    def kwargs(self) -> dict[str, Any]:
        """The choices this id stands for; each can be overridden in `make`."""
        return {"obs": self.obs, "control": self.control, "reward": self.reward}


ENTRY_POINTS = {
    "reach": ("BabbleReachEnv", "BabbleReachVectorEnv"),
    "grasp": ("BabbleGraspEnv", "BabbleGraspVectorEnv"),
}
"""Single and vector environment of each task, in `gym_babble.envs`."""

ENVIRONMENTS = (
    Registered("BabbleReach-v0", "reach", "senses", "delta_posture", "progress", 240, 2.3),
    Registered("BabbleReachSparse-v0", "reach", "senses", "delta_posture", "sparse", 240, 0.9),
    Registered("BabbleReachGoal-v0", "reach", "goal", "delta_posture", "sparse", 240, -120.0),
    Registered("BabbleReachPattern-v0", "reach", "senses", "pattern", "sparse", None, 0.9),
    Registered("BabbleGrasp-v0", "grasp", "senses", "delta_posture", "progress", None, 5.5),
    Registered("BabbleGraspSparse-v0", "grasp", "senses", "delta_posture", "sparse", None, 0.9),
    Registered("BabbleGraspGoal-v0", "grasp", "goal", "delta_posture", "sparse", None, None),
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
