"""The native batch in RLlib's new API stack.

>>> from ray.rllib.algorithms.ppo import PPOConfig
>>> from gym_babble.rllib import native_batch
>>> config = native_batch(PPOConfig(), "BabbleGrasp-v0", num_envs=64)

`pip install 'gym-babble[rllib]'`; RLlib pins its own Gymnasium.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode

from gym_babble.errors import ConfigError, MissingExtraError

try:
    import torch
    from ray.rllib.connectors.env_to_module import FlattenObservations
    from ray.rllib.utils.spaces.space_utils import clip_action, unsquash_action
except ImportError as error:
    raise MissingExtraError("RLlib", "rllib") from error

if TYPE_CHECKING:
    from numpy.typing import NDArray

C = TypeVar("C")

__all__ = ["RLlibAgent", "flatten", "log_success", "native_batch"]


def native_batch(algorithm_config: C, env_id: str, num_envs: int = 1, **env_kwargs: Any) -> C:
    """Makes an algorithm of RLlib learn in native batches, one in each env runner.

    Sets what `config.environment` and `config.env_runners` take, and can be followed by further
    calls of both, e.g. `.env_runners(num_env_runners=4)`. A Dict of senses reaches the networks as
    one array, by `flatten`. The results have RLlib's `episode_return_mean`, and beside it
    `success_rate`, by `log_success`.

    Args:
        algorithm_config: An `AlgorithmConfig` of RLlib. It is changed.
        env_id: A registered id of this package.
        num_envs: Environments in each batch.
        env_kwargs: Further arguments of the environment and of its batch. `threads` is 1 unless
            given, because RLlib counts one processor for each env runner.

    Returns:
        The same `AlgorithmConfig`.

    Raises:
        ConfigError: An unknown or invalid argument.
    """
    env_kwargs.setdefault("threads", 1)
    envs = gymnasium.make_vec(env_id, num_envs=num_envs, **env_kwargs)
    senses = envs.single_observation_space
    if envs.metadata["autoreset_mode"] is not AutoresetMode.NEXT_STEP:
        raise ConfigError("autoreset_mode: RLlib needs AutoresetMode.NEXT_STEP")
    envs.close()
    # The prefix makes each of Ray's workers import the package.
    made: Any = algorithm_config
    made.environment(f"gym_babble:{env_id}", env_config=env_kwargs)
    made.env_runners(num_envs_per_env_runner=num_envs, gym_env_vectorize_mode="vector_entry_point")
    if isinstance(senses, spaces.Dict):
        made.env_runners(env_to_module_connector=flatten)
    made.callbacks(on_episode_end=log_success)
    return algorithm_config


def flatten(env: Any, spaces: Any, device: Any) -> Any:  # noqa: ARG001 - RLlib's names
    """Connector for networks that take one array: `env_runners(env_to_module_connector=flatten)`.

    It puts the senses of the Dict one after the other, in the order of their names.
    """
    return FlattenObservations()


def log_success(*, episode: Any, env_runner: Any, metrics_logger: Any, **_: Any) -> None:
    """Logs the `success_rate` of ended episodes: `callbacks(on_episode_end=log_success)`.

    It is a mean over as many episodes as RLlib's `episode_return_mean`: the last 100, unless
    `config.reporting(metrics_num_episodes_for_smoothing=n)` says more.
    """
    success = float(episode.get_infos(-1)["is_success"])
    window = env_runner.config.metrics_num_episodes_for_smoothing
    metrics_logger.log_value("success_rate", success, reduce="mean", window=window)


class RLlibAgent:
    """The policy of an algorithm of RLlib, with stable-baselines3's `predict`.

    `gym_babble.evaluate(RLlibAgent(algorithm))` tests it as it is now, where it learns.

    Args:
        algorithm: An algorithm whose config `native_batch` has made. Its policy must have no
            memory.

    Raises:
        ConfigError: Other connectors than `flatten` change what its networks see.
    """

    def __init__(self, algorithm: Any) -> None:
        config = algorithm.config
        if vars(config)["_env_to_module_connector"] not in (None, flatten):
            raise ConfigError("env_to_module_connector: RLlibAgent knows none but flatten")
        envs: Any = gymnasium.make_vec(config.env, num_envs=1, **config.env_config)
        self.interface = envs.unwrapped.interface
        envs.close()
        self._algorithm = algorithm

    def predict(
        self,
        observation: Any,
        state: Any = None,
        episode_start: Any = None,  # noqa: ARG002 - stable-baselines3's signature
        deterministic: bool = False,  # noqa: FBT001, FBT002 - the same
    ) -> tuple[NDArray[np.float32], Any]:
        """Actions (n, k) for n observations, or one action (k,) for one observation."""
        module, config = self._algorithm.get_module(), self._algorithm.config
        seen, batched = self._as_rows(observation)
        with torch.no_grad():
            forward = module.forward_inference if deterministic else module.forward_exploration
            logits = forward({"obs": torch.from_numpy(seen)})["action_dist_inputs"]
            actions = module.get_inference_action_dist_cls().from_logits(logits)
            chosen = (actions.to_deterministic() if deterministic else actions).sample().numpy()
        space = self.interface.action_space
        if config.normalize_actions:
            chosen = unsquash_action(chosen, space)
        elif config.clip_actions:
            chosen = clip_action(chosen, space)
        return chosen if batched else chosen[0], state

    def _as_rows(self, observation: Any) -> tuple[NDArray[np.float32], bool]:
        """Observations in the form of `flatten` (n, width), and whether there were several."""
        space = self.interface.observation_space
        names = sorted(space) if isinstance(space, spaces.Dict) else [None]
        parts = [
            (observation, space) if name is None else (observation[name], space[name])
            for name in names
        ]
        first, box = parts[0]
        batched = np.ndim(first) > len(box.shape)
        n = len(first) if batched else 1
        rows = [np.reshape(array, (n, -1)).astype(np.float32) for array, _ in parts]
        return np.concatenate(rows, axis=1), batched
