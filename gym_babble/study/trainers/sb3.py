"""Trains PPO, SAC and TD3 of stable-baselines3 with tuned settings, and SAC with hindsight replay.

>>> from gym_babble.study.trainers.sb3 import train_tuned
>>> model = train_tuned("ppo", "BabbleReachPattern-v0")  # 16,384 movements
>>> model.save("reaching.zip")  # `gym_babble.evaluate("reaching.zip")` knows where it acts.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import replace
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents.acting import MARK, marked
from gym_babble.checks import check_seed, check_whole, shown
from gym_babble.config import Config
from gym_babble.envs.registry import environment
from gym_babble.errors import ConfigError, DivergedError, MissingExtraError
from gym_babble.sb3 import BabbleVecEnv, ProgressBar
from gym_babble.study.trainers.base import Cost, Order, arguments_of, check_settings
from gym_babble.study.trainers.sb3_models import check_control, made_model, setting_names
from gym_babble.study.tuned import tuned_settings

try:
    import torch
    from stable_baselines3.common.callbacks import BaseCallback, CallbackList
except ImportError as error:
    raise MissingExtraError("stable-baselines3", "sb3") from error

if TYPE_CHECKING:
    from collections.abc import Callable

    from gym_babble.agents.acting import EnvArguments
    from gym_babble.config import ConfigLike

__all__ = ["SB3Trainer", "ppo", "sac", "td3", "train_tuned"]

MOST_STEPS = 10**12


class SB3Trainer:
    """Trains a model of stable-baselines3 on the native batch, with one thread of PyTorch.

    It makes PyTorch use one thread in the whole process: networks this small gain nothing from a
    second one, and results depend on their number. Linear schedules end with the order's budget.

    Args:
        order: What to train. Its `settings` replace the tuned ones. They are the arguments of
            stable-baselines3's class, in rl-zoo3's form or as Python has them, and `n_envs`,
            environments stepped together; `senses`, those that the networks get; `noise_type`
            ("normal") and `noise_std`, the noise on TD3's actions; `learning_options`, options of
            the environment that hold while learning, and not in tests.
        algorithm: "ppo", "sac" or "td3".

    Raises:
        ConfigError: No tuned settings for the environment, an unknown setting or one that does not
            fit, or a control that the settings are not for.
    """

    def __init__(self, order: Order, algorithm: str) -> None:
        torch.set_num_threads(1)
        env_id = order.env_id
        if env_id is None:
            raise ConfigError("env_id is missing: name the environment to learn in")
        settings = tuned_settings(algorithm, env_id)
        del settings["n_timesteps"]  # The order has the budget.
        settings |= check_settings(order, setting_names(algorithm))
        tuned_options = settings.pop("env_kwargs", {})
        check_control(env_id, tuned_options, order.options)
        options = tuned_options | order.options
        self.arguments: EnvArguments = arguments_of(replace(order, options=options), env_id)
        num_envs = check_whole("n_envs", settings.pop("n_envs"), 1, 65_536, "environments")
        options |= _mapping("learning_options", settings.pop("learning_options", {}))
        env = BabbleVecEnv(env_id, num_envs, config=order.config, threads=1, **options)
        self.agent: Any = made_model(algorithm, env, settings, order.seed)
        self._per_step = control_steps_per_step(self.arguments)
        self._budget = order.budget
        self._episodes = 0

    @property
    def cost(self) -> Cost:
        """The cost of learning so far."""
        return Cost(trials=self._episodes, control_steps=self.agent.num_timesteps * self._per_step)

    def train(
        self,
        control_steps: int,
        pause: Callable[[], None],
        callback: BaseCallback | None = None,
    ) -> None:
        """Learns in whole rollouts until at least so many control steps have been used in all.

        Args:
            control_steps: Where to stop.
            pause: Called after each rollout and its updates.
            callback: A callback of stable-baselines3.

        Raises:
            DivergedError: The weights became NaN or infinite.
        """
        until = math.ceil(control_steps / self._per_step)
        total = max(until, math.ceil(self._budget / self._per_step))
        left = total - self.agent.num_timesteps
        if self.agent.num_timesteps >= until:
            return
        watch = _Watch(self, until, pause)
        callbacks = CallbackList([watch] if callback is None else [watch, callback])
        try:
            self.agent.learn(left, callbacks, reset_num_timesteps=False)
        except _Reached:
            pass
        except ValueError as error:
            self.check_weights(error)
            if "Expected parameter" in str(error):  # From PyTorch's distributions.
                raise self._diverged("its actions have no mean or no deviation") from error
            raise
        self.check_weights()
        pause()

    def check_weights(self, cause: Exception | None = None) -> None:
        """Raises `DivergedError` if a weight is NaN or infinite."""
        for name, weights in self.agent.policy.named_parameters():
            if not bool(torch.isfinite(weights).all()):
                raise self._diverged(f"{name} is NaN or infinite") from cause

    def _diverged(self, problem: str) -> DivergedError:
        return DivergedError(
            f"the policy returns NaN after {self.cost.control_steps} control steps: {problem}; a "
            "smaller learning_rate may help"
        )

    def count(self, episodes: int) -> None:
        """Adds episodes that have ended to the cost."""
        self._episodes += episodes

    def mark(self) -> None:
        """Notes in the model where it acts; its zip keeps it."""
        updates = self.agent._n_updates  # noqa: SLF001 - it has no public name
        setattr(self.agent, MARK, marked(self.arguments, updates))

    def save(self) -> tuple[str, bytes]:
        """The model as a zip, which says where it acts."""
        self.mark()
        buffer = BytesIO()
        self.agent.save(buffer)
        return ".zip", buffer.getvalue()


class _Reached(Exception):  # noqa: N818 - not an error
    """The trainer has reached the end of its piece, between two rollouts."""


class _Watch(BaseCallback):
    """Counts episodes; between two rollouts checks the weights, and stops or pauses."""

    def __init__(self, trainer: SB3Trainer, until: int, pause: Callable[[], None]) -> None:
        super().__init__()
        self._trainer, self._until, self._pause = trainer, until, pause
        self._first = True

    def _on_rollout_start(self) -> None:
        if not self._first:
            self._trainer.check_weights()
            if self.num_timesteps >= self._until:
                raise _Reached
            self._pause()
        self._first = False

    def _on_step(self) -> bool:
        self._trainer.count(int(np.count_nonzero(self.locals["dones"])))
        return True


def ppo(order: Order) -> SB3Trainer:
    """PPO."""
    return SB3Trainer(order, "ppo")


def sac(order: Order) -> SB3Trainer:
    """SAC; in BabbleReachGoal-v0 with hindsight replay."""
    return SB3Trainer(order, "sac")


def td3(order: Order) -> SB3Trainer:
    """TD3."""
    return SB3Trainer(order, "td3")


def _mapping(name: str, value: Any) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise ConfigError(f"settings.{name} = {shown(value)} is not a table of names and values")
    return value


def control_steps_per_step(arguments: EnvArguments) -> int:
    """Control steps of one step: a whole movement in `pattern` control, else 1."""
    if arguments.option("control") != "pattern":
        return 1
    return Config.from_json(json.dumps(arguments.config)).movement_steps


def train_tuned(
    algorithm: str,
    env_id: str,
    *,
    seed: int = 0,
    steps: int | None = None,
    config: ConfigLike = "paper",
    settings: Mapping[str, Any] | None = None,
    progress_bar: bool = False,
    **options: Any,
) -> Any:
    """Trains a model of stable-baselines3 with the tuned settings.

    Args:
        algorithm: "ppo", "sac" or "td3".
        env_id: Environment to learn in.
        seed: Seed of the networks and of the cases.
        steps: Steps of all environments together; the tuned settings' `n_timesteps` if not given.
            In `pattern` control these are movements.
        config: Body and task.
        settings: Settings in place of tuned ones, as for `SB3Trainer`.
        progress_bar: Show a progress bar.
        options: Further options of the environment.

    Returns:
        The model. It says where it acts, and so does the zip that its `save` writes.

    Raises:
        ConfigError: As for `SB3Trainer`.
        DivergedError: The weights became NaN or infinite.
    """
    if steps is None:
        steps = int(tuned_settings(algorithm, env_id)["n_timesteps"])
    check_whole("steps", steps, 1, MOST_STEPS, "steps")
    order = Order(
        task=environment(env_id).task,
        seed=check_seed(seed),
        budget=0,
        config=config,
        env_id=env_id,
        options=options,
        settings=dict(settings or {}),
    )
    trainer = SB3Trainer(order, algorithm)
    bar = ProgressBar(algorithm) if progress_bar else None
    trainer.train(steps * control_steps_per_step(trainer.arguments), lambda: None, bar)
    trainer.mark()
    return trainer.agent
