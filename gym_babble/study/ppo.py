"""Tuned PPO from stable-baselines3 on both tasks, the baseline beside Hebb babbling.

docs/baselines.md says how the settings were found and what they reach.
"""

from __future__ import annotations

import math
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from gymnasium import spaces

from gym_babble.config import Config
from gym_babble.errors import ConfigError, MissingExtraError
from gym_babble.sb3 import BabbleVecEnv, ProgressBar
from gym_babble.study.evaluation import evaluate
from gym_babble.study.scenarios import scenarios
from gym_babble.study.tasks import task_of

try:
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback, CallbackList
    from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
    from stable_baselines3.common.utils import LinearSchedule
except ImportError as error:
    raise MissingExtraError("stable-baselines3", "sb3") from error

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from gym_babble.config import ConfigLike

__all__ = [
    "PRESETS",
    "ChosenSenses",
    "CurvePoint",
    "Preset",
    "TrainedPPO",
    "one_thread",
    "train_ppo",
]


class ChosenSenses(BaseFeaturesExtractor):
    """Passes some of the senses on to the networks, side by side; the others stay unseen."""

    def __init__(self, observation_space: spaces.Dict, senses: tuple[str, ...]) -> None:
        width = sum(spaces.flatdim(observation_space[name]) for name in senses)
        super().__init__(observation_space, width)
        self._senses = senses

    def forward(self, observations: dict[str, torch.Tensor]) -> torch.Tensor:
        """The chosen senses (n, width) of a batch of observations."""
        return torch.cat([observations[name] for name in self._senses], dim=1)


@dataclass(frozen=True, kw_only=True)
class Preset:
    """What to learn in, from which senses, for how long, and with which settings."""

    env_id: str
    """Environment."""
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    """Further arguments of the environment; the config is not among them."""
    senses: tuple[str, ...]
    """The senses that the networks are given."""
    num_envs: int
    """Environments stepped together."""
    steps: int
    """Steps of all environments together; in `pattern` control these are movements."""
    settings: dict[str, Any] = field(default_factory=dict)
    """Arguments of stable-baselines3's PPO."""
    policy: dict[str, Any] = field(default_factory=dict)
    """Its `policy_kwargs`."""

    def to_json(self) -> dict[str, Any]:
        """All of it in JSON's types; a rate that falls linearly as [first, last]."""
        return {name: _plain(value) for name, value in vars(self).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, LinearSchedule):
        return [value.start, value.end]
    return value.__name__ if isinstance(value, type) else value


ALL_SENSES = ("eye", "obstacle", "hand", "arm", "stretch", "time")
"""Those of reaching."""


def _pattern(*senses: str) -> Preset:
    return Preset(
        env_id="BabbleReachPattern-v0",
        senses=senses,
        num_envs=64,
        steps=16_384,
        settings={
            "n_steps": 8,
            "batch_size": 128,
            "n_epochs": 20,
            "learning_rate": 1e-3,
            "gamma": 0.0,
            "gae_lambda": 1.0,
        },
        # From -1.5 on: at 0 most actions are clipped, and the policy stays there.
        policy={"activation_fn": torch.nn.ReLU, "net_arch": [128, 128], "log_std_init": -1.5},
    )


PRESETS: dict[str, Preset] = {
    "pattern": _pattern(*ALL_SENSES),
    "pattern_obstacle": _pattern("obstacle"),
    "pattern_eye_obstacle": _pattern("eye", "obstacle"),
    "delta_posture": Preset(
        env_id="BabbleReach-v0",
        senses=ALL_SENSES,
        num_envs=128,
        steps=1_000_000,
        settings={
            "n_steps": 64,
            "batch_size": 1024,
            "n_epochs": 5,
            "learning_rate": LinearSchedule(2.5e-3, 0.0, 1.0),
            "gamma": 0.99,
            "gae_lambda": 0.95,
        },
        policy={"activation_fn": torch.nn.ReLU, "net_arch": [128, 128], "log_std_init": -0.5},
    ),
    "grasp": Preset(
        env_id="BabbleGrasp-v0",
        senses=("eye", "fovea", "arm", "hand", "stretch", "touch", "time"),
        num_envs=128,
        steps=2_500_000,
        settings={
            "n_steps": 64,
            "batch_size": 1024,
            "n_epochs": 5,
            "learning_rate": LinearSchedule(1e-3, 0.0, 1.0),
            "gamma": 0.99,
            "gae_lambda": 0.95,
        },
        policy={"activation_fn": torch.nn.ReLU, "net_arch": [128, 128], "log_std_init": -0.5},
    ),
}
"""The presets by name. `pattern_obstacle` is given what the paper's agent sees,
`pattern_eye_obstacle` what the conjunctive variant sees, the others every sense; `grasp` is for
grasping in `delta_posture` control."""


class CurvePoint(NamedTuple):
    """One point of a learning curve."""

    steps: int
    """Steps learnt from; in `pattern` control movements."""
    seconds: float
    """Clock time of learning, validation not counted [s]."""
    success: float
    """Share of the validation cases that succeeded."""


@dataclass(frozen=True)
class TrainedPPO:
    """An agent and how it came about."""

    agent: PPO
    """The agent; `agent.predict` is what `gym_babble.evaluate` needs."""
    env_id: str
    """Environment that it learnt in."""
    env_kwargs: dict[str, Any]
    """Further arguments of the environment, for `evaluate`; the config is not among them."""
    movements: int
    """Episodes that ended while it learnt; in `pattern` control each is one movement."""
    control_steps: int
    """Control steps learnt from; a movement in `pattern` control counts with its whole length."""
    seconds: float
    """Clock time of learning, validation not counted [s]."""
    curve: tuple[CurvePoint, ...]
    """Success on validation cases while it learnt."""


def train_ppo(
    preset: str | Preset,
    *,
    config: ConfigLike = "paper",
    seed: int = 0,
    steps: int | None = None,
    validation_cases: int = 200,
    validations: int = 10,
    progress_bar: bool = False,
    callback: BaseCallback | None = None,
) -> TrainedPPO:
    """Trains PPO on the environment's own draw of cases, with one thread of PyTorch.

    Args:
        preset: A name in `PRESETS`, or a preset of your own.
        config: Body and task, as for the environments.
        seed: Seed of the networks and of the cases.
        steps: Steps of all environments together, rounded up to whole rollouts; the preset's if
            not given. In `pattern` control these are movements.
        validation_cases: Cases of the learning curve, of the task's tests and split "validation"; 0
            for no curve.
        validations: Points of the learning curve.
        progress_bar: Show a bar with the time left.
        callback: A callback of stable-baselines3 of your own.

    Raises:
        ConfigError: There is no preset of that name, or a number is out of bounds.
    """
    chosen = _preset(preset)
    _check(steps, validation_cases, validations)
    protocol = task_of(chosen.env_id).protocol
    with one_thread():
        env = BabbleVecEnv(chosen.env_id, chosen.num_envs, config=config, **chosen.env_kwargs)
        model = _model(chosen, env, seed)
        cases = (
            scenarios(protocol, validation_cases, split="validation", config=config)
            if validation_cases
            else []
        )

        def validate() -> float:
            played = evaluate(model, chosen.env_id, cases, config=config, **chosen.env_kwargs)
            return played.rate("success")

        rollouts = math.ceil((steps or chosen.steps) / (model.n_steps * env.num_envs))
        course = _Course(rollouts, validations if cases else 0, validate)
        callbacks = [course, *([ProgressBar("PPO")] if progress_bar else [])]
        callbacks += [callback] if callback is not None else []
        model.learn(rollouts * model.n_steps * env.num_envs, callback=CallbackList(callbacks))
        env.close()
    return TrainedPPO(
        agent=model,
        env_id=chosen.env_id,
        env_kwargs=dict(chosen.env_kwargs),
        movements=course.episodes,
        control_steps=model.num_timesteps * _control_steps(env),
        seconds=course.seconds,
        curve=tuple(course.curve),
    )


class _Course(BaseCallback):
    """Counts episodes, keeps the clock and the learning curve."""

    def __init__(self, rollouts: int, validations: int, validate: Callable[[], float]) -> None:
        super().__init__()
        self.episodes = 0
        self.seconds = 0.0
        self.curve: list[CurvePoint] = []
        self._validate = validate
        self._ends = {math.ceil(rollouts * k / validations) for k in range(1, validations + 1)}
        self._rollout = 0
        self._began = 0.0

    def _on_training_start(self) -> None:
        self._began = perf_counter()

    def _on_rollout_start(self) -> None:
        self._pass_rollout()
        self._rollout += 1

    def _on_step(self) -> bool:
        self.episodes += int(np.count_nonzero(self.locals["dones"]))
        return True

    def _on_training_end(self) -> None:
        self._pass_rollout()

    def _pass_rollout(self) -> None:
        """What is due between two rollouts: the last one has been learnt from."""
        self.seconds += perf_counter() - self._began
        if self._rollout in self._ends:
            self.curve.append(CurvePoint(self.num_timesteps, self.seconds, self._validate()))
        self._began = perf_counter()


def _preset(preset: str | Preset) -> Preset:
    if isinstance(preset, Preset):
        return preset
    if preset not in PRESETS:
        raise ConfigError(f"preset = {preset!r} is not one of {', '.join(PRESETS)}")
    return PRESETS[preset]


def _check(steps: int | None, validation_cases: int, validations: int) -> None:
    if steps is not None and steps < 1:
        raise ConfigError(f"steps = {steps} is not at least 1")
    if validation_cases < 0:
        raise ConfigError(f"validation_cases = {validation_cases} is not at least 0")
    if validations < 1:
        raise ConfigError(f"validations = {validations} is not at least 1")


def _model(preset: Preset, env: BabbleVecEnv, seed: int) -> PPO:
    extractor = {
        "features_extractor_class": ChosenSenses,
        "features_extractor_kwargs": {"senses": preset.senses},
    }
    model = PPO(
        "MultiInputPolicy",
        env,
        seed=seed,
        device="cpu",
        policy_kwargs={**extractor, **preset.policy},
        **preset.settings,
    )
    # PPO has seeded environment i with seed + i: another seed would share nearly all the cases.
    env.seed(seed * env.num_envs)
    return model


def _control_steps(env: BabbleVecEnv) -> int:
    """Control steps of one step: a whole movement in `pattern` control, else 1."""
    choices = env.get_attr("choices")[0]
    if choices.control != "pattern":
        return 1
    return Config.from_json(choices.task.config()).movement_steps


@contextmanager
def one_thread() -> Iterator[None]:
    """These networks are too small for a second thread of PyTorch to help."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)
