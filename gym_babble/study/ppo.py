"""PPO from stable-baselines3 on both tasks, to compare with Hebb babbling."""

from __future__ import annotations

import math
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gym_babble.agents.acting import MARK, EnvArguments, marked
from gym_babble.config import Config
from gym_babble.errors import ConfigError, MissingExtraError
from gym_babble.sb3 import BabbleVecEnv, ProgressBar
from gym_babble.study.evaluation import evaluate
from gym_babble.study.presets import PRESETS, ChosenSenses, Preset
from gym_babble.study.scenarios import scenarios
from gym_babble.study.tasks import task_of

try:
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback, CallbackList
except ImportError as error:
    raise MissingExtraError("stable-baselines3", "sb3") from error

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from gym_babble.config import ConfigLike

__all__ = ["CurvePoint", "TrainedPPO", "one_thread", "train_ppo"]


class CurvePoint(NamedTuple):
    """One point of a learning curve."""

    steps: int
    """Steps learnt from; in `pattern` control, movements."""
    seconds: float
    """Clock time of learning without validation [s]."""
    success: float
    """Success rate on the validation cases."""


@dataclass(frozen=True)
class TrainedPPO:
    """A trained agent and its training."""

    agent: PPO
    """The agent, which `gym_babble.evaluate` can test. It says where it learnt, and so does the
    zip that its `save` writes."""
    env_id: str
    """Id of the environment in which it learnt."""
    movements: int
    """Episodes that ended during learning; in `pattern` control each is one movement."""
    control_steps: int
    """Control steps learnt from; a movement in `pattern` control counts with all its steps."""
    seconds: float
    """Clock time of learning without validation [s]."""
    curve: tuple[CurvePoint, ...]
    """Success on validation cases during learning."""


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
    """Trains PPO on cases sampled by the environment, with one thread of PyTorch.

    Args:
        preset: A name in `PRESETS`, or a preset of your own.
        config: Body and task, as for the environments.
        seed: Seed of the networks and of the cases.
        steps: Steps of all environments together, rounded up to whole rollouts; the preset's by
            default. In `pattern` control these are movements.
        validation_cases: Cases of the learning curve, from the task's protocol and the split
            "validation"; 0 for no curve.
        validations: Points of the learning curve.
        progress_bar: Show a progress bar.
        callback: A stable-baselines3 callback of your own.

    Raises:
        ConfigError: An unknown preset, or a number out of bounds.
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
            return evaluate(model, cases=cases).rate("success")

        rollouts = math.ceil((steps or chosen.steps) / (model.n_steps * env.num_envs))
        recorder = _Recorder(rollouts, validations if cases else 0, validate)
        callbacks = [recorder, *([ProgressBar("PPO")] if progress_bar else [])]
        callbacks += [callback] if callback is not None else []
        model.learn(rollouts * model.n_steps * env.num_envs, callback=CallbackList(callbacks))
        place = EnvArguments.of(env.get_attr("interface")[0])
        setattr(model, MARK, marked(place, model._n_updates))  # noqa: SLF001 - no public name
        env.close()
    return TrainedPPO(
        agent=model,
        env_id=chosen.env_id,
        movements=recorder.episodes,
        control_steps=model.num_timesteps * _control_steps(env),
        seconds=recorder.seconds,
        curve=tuple(recorder.curve),
    )


class _Recorder(BaseCallback):
    """Records episodes, clock time and the learning curve."""

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
        """Called between two rollouts, after PPO has learnt from the last one."""
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
    # PPO has seeded environment i with seed + i, so nearby seeds would share most cases.
    env.seed(seed * env.num_envs)
    return model


def _control_steps(env: BabbleVecEnv) -> int:
    """Control steps of one step: a whole movement in `pattern` control, else 1."""
    interface = env.get_attr("interface")[0]
    if interface.options["control"] != "pattern":
        return 1
    return Config.from_json(interface.task.config()).movement_steps


@contextmanager
def one_thread() -> Iterator[None]:
    """Limits PyTorch to one thread; with networks this small a second one does not help."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)
