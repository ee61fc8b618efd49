"""The native batch as a stable-baselines3 `VecEnv`.

>>> from stable_baselines3 import PPO
>>> from gym_babble.sb3 import BabbleVecEnv
>>> model = PPO("MultiInputPolicy", BabbleVecEnv("BabbleReach-v0", 128))
"""

from __future__ import annotations

import math
import time
import warnings
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode

from gym_babble.checks import check_choice
from gym_babble.errors import ConfigError, MissingExtraError
from gym_babble.progress import track

try:
    import torch
    from stable_baselines3.common.callbacks import BaseCallback
    from stable_baselines3.common.monitor import Monitor
    from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as error:
    raise MissingExtraError("stable-baselines3", "sb3") from error

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray
    from stable_baselines3.common.vec_env.base_vec_env import (
        VecEnvIndices,
        VecEnvObs,
        VecEnvStepReturn,
    )

__all__ = ["BabbleVecEnv", "ChosenSenses", "ProgressBar"]


class BabbleVecEnv(VecEnv):
    """Many environments of one id, stepped together in the core.

    It behaves like a `DummyVecEnv` of the same environments, each in a `Monitor`. With seed s,
    environment i equals the single environment with seed s + i. An ended episode restarts in the
    same step, with `terminal_observation`, `TimeLimit.truncated` and `episode` in its info. Options
    of `set_options` apply to the next reset and to all later episodes.

    Args:
        env_id: A registered id.
        num_envs: Number of environments.
        url: Address of a server that has the environments; here in this process if not given. Then
            `env_kwargs` may have those of `gym_babble.remote.RemoteVectorEnv`, e.g. `token`.
        env_kwargs: Further arguments of the environment and of its batch, e.g. `threads=1`.

    Raises:
        ConfigError: An unknown or invalid argument.
    """

    def __init__(
        self,
        env_id: str = "BabbleReach-v0",
        num_envs: int = 1,
        *,
        url: str | None = None,
        **env_kwargs: Any,
    ) -> None:
        env_kwargs.setdefault("autoreset_mode", AutoresetMode.SAME_STEP)
        self.envs: Any = _batch(env_id, num_envs, url, env_kwargs)
        if self.envs.metadata["autoreset_mode"] is not AutoresetMode.SAME_STEP:
            raise ConfigError("autoreset_mode: stable-baselines3 needs AutoresetMode.SAME_STEP")
        super().__init__(
            num_envs, self.envs.single_observation_space, self.envs.single_action_space
        )
        self.metadata = self.envs.metadata
        self._actions: Any = None
        self._returns = np.zeros(num_envs)
        self._lengths = np.zeros(num_envs, np.int64)
        self._began = time.time()

    def reset(self) -> VecEnvObs:
        """Starts new episodes, with the seeds of `seed` and the options of `set_options`.

        Raises:
            ConfigError: An unknown option.
            ScenarioError: A requested case that cannot be played.
        """
        seeds, options = self._seeds, self._options
        self._reset_seeds()
        self._reset_options()
        observation, infos = self.envs.reset(
            seed=None if all(seed is None for seed in seeds) else seeds,
            options={"scenario": [_as_scenario(new) if new else None for new in options]},
        )
        self._returns[:] = 0.0
        self._lengths[:] = 0
        self.reset_infos = _list_of_infos(infos, self.num_envs)
        return observation  # type: ignore[no-any-return]

    def step_async(self, actions: NDArray[Any]) -> None:
        """Stores the actions of the next step (n, k)."""
        self._actions = actions

    def step_wait(self) -> VecEnvStepReturn:
        """Steps all environments. Those that end restart.

        Raises:
            ActionError: An action with NaN, infinity, or a wrong shape or type.
            gymnasium.error.ResetNeeded: A step before the first reset.
        """
        observation, rewards, terminated, truncated, infos = self.envs.step(self._actions)
        dones = terminated | truncated
        self._returns += rewards
        self._lengths += 1
        last_obs = infos.pop("final_obs", None)
        last_infos = _list_of_infos(infos.pop("final_info", {}), self.num_envs)
        listed = _list_of_infos(infos, self.num_envs)
        for i in np.flatnonzero(dones).tolist():
            self.reset_infos[i], listed[i] = listed[i], last_infos[i]
            listed[i]["terminal_observation"] = last_obs[i]
            listed[i]["episode"] = self._end_episode(i)
        for info, late in zip(listed, (truncated & ~terminated).tolist(), strict=True):
            info["TimeLimit.truncated"] = late
        return observation, rewards.astype(np.float32), dones, listed

    def _end_episode(self, i: int) -> dict[str, Any]:
        """The statistics of `Monitor`: return, length, seconds since the start."""
        statistics = {
            "r": round(float(self._returns[i]), 6),
            "l": int(self._lengths[i]),
            "t": round(time.time() - self._began, 6),
        }
        self._returns[i] = 0.0
        self._lengths[i] = 0
        return statistics

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """An attribute of each environment."""
        return [self._of_one(i, attr_name) for i in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Sets an attribute of your own in each environment.

        Raises:
            AttributeError: The environments themselves have an attribute of this name.
        """
        for i in self._get_indices(indices):
            self.envs.set_of_one(i, attr_name, value)

    def env_method(
        self,
        method_name: str,
        *method_args: Any,
        indices: VecEnvIndices = None,
        **method_kwargs: Any,
    ) -> list[Any]:
        """Calls a method of each environment."""
        methods = self.get_attr(method_name, indices)
        return [method(*method_args, **method_kwargs) for method in methods]

    def env_is_wrapped(
        self,
        wrapper_class: type[gymnasium.Wrapper[Any, Any, Any, Any]],
        indices: VecEnvIndices = None,
    ) -> list[bool]:
        """Whether the wrapper is `Monitor`, the only one whose function the batch includes."""
        return [issubclass(Monitor, wrapper_class) for _ in self._get_indices(indices)]

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """A picture of each environment (height, width, 3), with render_mode "rgb_array"."""
        if self.render_mode != "rgb_array":
            warnings.warn(
                f"render_mode is {self.render_mode!r}; get_images() needs 'rgb_array'", stacklevel=2
            )
            return [None] * self.num_envs
        return list(self.envs.render())

    def close(self) -> None:
        """Closes the batch."""
        self.envs.close()

    def _of_one(self, i: int, name: str) -> Any:
        if name in ("reset", "step"):
            raise AttributeError(
                f"{name}: single environments cannot {name}; use that of the batch"
            )
        return self.envs.of_one(i, name)


class ChosenSenses(BaseFeaturesExtractor):
    """A features extractor that passes only some senses to the networks.

    >>> extractor = {
    ...     "features_extractor_class": ChosenSenses,
    ...     "features_extractor_kwargs": {"senses": ["obstacle"]},
    ... }
    >>> env = BabbleVecEnv("BabbleReachPattern-v0")
    >>> model = PPO("MultiInputPolicy", env, policy_kwargs=extractor)

    Raises:
        ConfigError: No senses, or one that the observation does not have.
    """

    def __init__(self, observation_space: spaces.Dict, senses: Sequence[str]) -> None:
        if not isinstance(observation_space, spaces.Dict):
            raise ConfigError('senses: the observation has no named senses; use obs="senses"')
        for name in senses:
            check_choice("senses", name, observation_space)
        if not senses:
            raise ConfigError("senses is empty: it must have at least one")
        width = sum(spaces.flatdim(observation_space[name]) for name in senses)
        super().__init__(observation_space, width)
        self.senses = tuple(senses)
        """Names of the senses, in their order."""

    def forward(self, observations: dict[str, torch.Tensor]) -> torch.Tensor:
        """The chosen senses of a batch of observations, concatenated (n, width)."""
        return torch.cat([observations[name] for name in self.senses], dim=1)


class ProgressBar(BaseCallback):
    """A progress bar with the time left: `model.learn(steps, callback=ProgressBar())`."""

    def __init__(self, text: str = "learning") -> None:
        super().__init__()
        self._text = text
        self._bar: Iterator[int] = iter(())

    def _on_training_start(self) -> None:
        total = self.locals["total_timesteps"] - self.model.num_timesteps
        n = self.training_env.num_envs
        self._bar = track([n] * math.ceil(total / n), self._text, total=total, show=True)
        next(self._bar, None)

    def _on_step(self) -> bool:
        next(self._bar, None)
        return True

    def _on_training_end(self) -> None:
        self._bar = iter(())


def _batch(env_id: str, num_envs: int, url: str | None, env_kwargs: dict[str, Any]) -> Any:
    """The batch here, or on a server."""
    if url is None:
        return gymnasium.make_vec(env_id, num_envs=num_envs, **env_kwargs)
    from gym_babble.remote import RemoteVectorEnv  # noqa: PLC0415 - it needs another extra

    return RemoteVectorEnv(env_id, num_envs, url=url, **env_kwargs)


def _as_scenario(options: dict[str, Any]) -> dict[str, Any]:
    """Options of one environment as a scenario, because the batch takes a list of scenarios."""
    scenario = options.get("scenario") or {}
    return {**scenario, **{name: value for name, value in options.items() if name != "scenario"}}


def _list_of_infos(infos: dict[str, Any], n: int) -> list[dict[str, Any]]:
    """One dict for each environment from Gymnasium's dict of arrays (masks are `_name`)."""
    columns = {
        name: _list_of_infos(value, n)
        if isinstance(value, dict)
        else value.tolist()
        if value.ndim == 1
        else list(value)
        for name, value in infos.items()
        if not name.startswith("_")
    }
    if not columns:
        return [{} for _ in range(n)]
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
