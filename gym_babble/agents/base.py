"""What all agents share: how they are called, where they act, numbers of their configs."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Protocol

import gymnasium
import numpy as np
from gymnasium.vector import VectorEnv

from gym_babble.envs.interface import Interface
from gym_babble.envs.registry import task_entry
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

__all__ = [
    "Agent",
    "EnvLike",
    "flat_senses",
    "interface_of",
    "merge",
    "processors",
]


EnvLike = Any
"""An id, or an environment: Gymnasium's, vector, or stable-baselines3's VecEnv."""


class Agent(Protocol):
    """What evaluation, comparison and videos need of an agent."""

    def predict(
        self,
        observation: Any,
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = False,  # noqa: FBT001, FBT002 - stable-baselines3's signature
    ) -> tuple[Any, Any]:
        """Actions for observations, and the state for the next call."""
        ...


def interface_of(env: EnvLike, task: str) -> Interface:
    """Options, spec and spaces of an environment of a task.

    Raises:
        ConfigError: It is not an environment of this package for that task.
    """
    if isinstance(env, str):
        env = gymnasium.make(env)
    if isinstance(env, gymnasium.Env | VectorEnv):
        found = getattr(env.unwrapped, "interface", None)
    elif hasattr(env, "get_attr"):
        found = env.get_attr("interface")[0]
    else:
        found = getattr(env, "interface", None)
    if not isinstance(found, Interface) or found.entry.name != task:
        raise ConfigError(f"{env!r} is not a Babble environment for {task_entry(task).title}")
    return found


def flat_senses(observation: Any, names: Iterable[str]) -> NDArray[np.float32]:
    """Flat senses (…, n) from any form of observation; `names` are the senses in their order."""
    if not isinstance(observation, dict):
        return np.asarray(observation, np.float32)
    if "observation" in observation:
        return np.asarray(observation["observation"], np.float32)
    return np.concatenate([observation[name] for name in names], axis=-1)


def merge(numbers: dict[str, Any], changes: Mapping[str, Any], path: str) -> None:
    """Replaces numbers of an agent's config.

    Raises:
        ConfigError: A field is not one there is.
    """
    for name, value in changes.items():
        if name not in numbers:
            raise ConfigError(f"{path}.{name}: unknown field; there are {', '.join(numbers)}")
        if isinstance(numbers[name], dict) and hasattr(value, "items"):
            merge(numbers[name], value, f"{path}.{name}")
        else:
            numbers[name] = value


def processors(threads: int | None) -> int:
    """A number of threads; all processors if not given."""
    return threads if threads is not None else (os.cpu_count() or 1)
