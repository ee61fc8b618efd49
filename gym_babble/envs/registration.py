"""Registers the core's environments with Gymnasium."""

from __future__ import annotations

from typing import TypeVar

import gymnasium

from gym_babble import envs
from gym_babble.envs.registry import ENVIRONMENTS

C = TypeVar("C", envs.BabbleEnv, envs.BabbleVectorEnv)

__all__ = ["register_all"]


def register_all() -> None:
    """Registers every environment with Gymnasium; calling it again is harmless."""
    single = {cls.task_name: name for name, cls in _classes(envs.BabbleEnv).items()}
    vector = {cls.task_name: name for name, cls in _classes(envs.BabbleVectorEnv).items()}
    for row in ENVIRONMENTS:
        if row.id in gymnasium.registry:
            continue
        # A task without classes of its own is an argument of the general ones.
        task = {} if row.task in single else {"task": row.task}
        gymnasium.register(
            id=row.id,
            entry_point=f"gym_babble.envs:{single.get(row.task, 'BabbleEnv')}",
            vector_entry_point=f"gym_babble.envs:{vector.get(row.task, 'BabbleVectorEnv')}",
            reward_threshold=row.reward_threshold,
            max_episode_steps=row.max_episode_steps,
            kwargs=task | row.presets,
        )


def _classes(base: type[C]) -> dict[str, type[C]]:
    """The exported classes of single tasks."""
    exported = {name: getattr(envs, name) for name in envs.__all__}
    return {
        name: cls
        for name, cls in exported.items()
        if isinstance(cls, type) and issubclass(cls, base) and cls is not base
    }
