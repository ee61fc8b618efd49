"""Who is compared: how each agent learns, and what learning took."""

from __future__ import annotations

import os
from contextlib import nullcontext
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

import gymnasium

from gym_babble.agents import (
    GraspRandom,
    GraspScripted,
    HebbBabbling,
    HebbGrasping,
    Oracle,
    RandomBabbling,
    Scripted,
)
from gym_babble.agents.grasping import BABBLE_S
from gym_babble.config import Config, config_json
from gym_babble.study.evaluation import evaluate
from gym_babble.study.scenarios import scenarios
from gym_babble.study.tasks import task_of

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike

__all__ = ["CONTENDERS", "Contender", "CurvePoint", "Learning", "Settings", "Trained"]

PATTERN = "BabbleReachPattern-v0"
GRASPING = "BabbleGrasp-v0"
VALIDATION_CASES = 200
# What a Hebb agent has learnt from when its curve has a point; multiples of its learning step.
LEGAL_MOVEMENTS = (250, 500, 1_000, 2_000, 5_000, 10_000, 20_000)
KEPT_BABBLES = (50, 100, 250, 500, 1_000)


@dataclass(frozen=True, kw_only=True)
class Settings:
    """What a comparison is made with."""

    task: str = "reach"
    """"reach" or "grasp"."""
    config: ConfigLike = "paper"
    """Body and task."""
    seeds: int = 1
    """Seeds 0, 1, ... of learning and tests."""
    cases: int = 1_000
    """Tests of each seed."""
    movements: int = 20_000
    """Legal movements that the Hebb agents of reaching learn from."""
    babbles: int = 1_000
    """Babbles that the Hebb agent of grasping learns from."""
    ppo_steps: int | None = None
    """Steps that PPO learns from; the preset's if None."""
    progress_bar: bool = False
    """Show bars with the time left."""


class CurvePoint(NamedTuple):
    """One point of a learning curve."""

    control_steps: int
    """Control steps simulated so far."""
    seconds: float
    """Clock time of learning, validation not counted [s]."""
    success: float
    """Share of 200 validation cases that succeeded."""


@dataclass(frozen=True, kw_only=True)
class Learning:
    """What learning took."""

    movements: int = 0
    """Movements or babbles made, or episodes ended while it learnt."""
    legal_movements: int | None = None
    """Of these the legal or kept ones, which a Hebb agent learns from."""
    control_steps: int = 0
    """Control steps simulated; a movement or babble counts with its whole length."""
    seconds: float = 0.0
    """Clock time of learning [s]."""
    curve: tuple[CurvePoint, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Trained(Learning):
    """An agent, where it acts, and what learning took."""

    agent: Agent
    env_id: str
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    while_acting: Callable[[], AbstractContextManager[None]] = nullcontext
    """What to enter for its test."""


@dataclass(frozen=True)
class Contender:
    """One row of the comparison."""

    key: str
    """Name for `--agents`."""
    title: str
    detail: str
    """What it decides on, or how."""
    train: Callable[[Settings, int], Trained] | None
    """How it learns with a seed; None for the stored study of its task."""
    slow_test: bool = False
    """Whether its test takes more than a moment."""
    asked_for: bool = False
    """Whether it takes part only when it is named."""


class _Course:
    """Keeps clock and learning curve of a Hebb agent while it babbles."""

    def __init__(self, settings: Settings, env_id: str, marks: set[int], steps: int) -> None:
        protocol = task_of(env_id).protocol
        self._cases = scenarios(
            protocol, VALIDATION_CASES, split="validation", config=settings.config
        )
        self._config, self._env_id = settings.config, env_id
        self._marks, self._steps = marks, steps
        self._began = perf_counter()
        self.seconds = 0.0
        self.curve: list[CurvePoint] = []

    def note(self, agent: Agent, made: int, good: int) -> None:
        """To be called as it learns, with what it has made and how many of these were good."""
        self.seconds += perf_counter() - self._began
        if good in self._marks:
            success = evaluate(agent, self._env_id, self._cases, config=self._config).rate(
                "success"
            )
            self.curve.append(CurvePoint(made * self._steps, self.seconds, success))
        self._began = perf_counter()

    def trained(self, agent: Agent, made: int, good: int) -> Trained:
        """What came out."""
        return Trained(
            agent=agent,
            env_id=self._env_id,
            movements=made,
            legal_movements=good,
            control_steps=made * self._steps,
            seconds=self.seconds,
            curve=tuple(self.curve),
        )


def _hebb(variant: str) -> Callable[[Settings, int], Trained]:
    def train(settings: Settings, seed: int) -> Trained:
        agent = HebbBabbling(gymnasium.make(PATTERN, config=settings.config), variant, seed=seed)
        steps = _config(settings).movement_steps
        course = _Course(settings, PATTERN, {*LEGAL_MOVEMENTS, settings.movements}, steps)
        agent.learn(
            settings.movements,
            progress_bar=settings.progress_bar,
            callback=lambda agent: course.note(agent, agent.movements, agent.legal_movements),
        )
        return course.trained(agent, agent.movements, agent.legal_movements)

    return train


def _hebb_grasping(settings: Settings, seed: int) -> Trained:
    agent = HebbGrasping(gymnasium.make(GRASPING, config=settings.config), seed=seed)
    steps = round(BABBLE_S / _config(settings).grasp.control_period_s)
    course = _Course(settings, GRASPING, {*KEPT_BABBLES, settings.babbles}, steps)
    agent.learn(
        settings.babbles,
        progress_bar=settings.progress_bar,
        callback=lambda agent: course.note(agent, agent.babbles, agent.kept),
    )
    return course.trained(agent, agent.babbles, agent.kept)


def _config(settings: Settings) -> Config:
    return Config.from_json(config_json(settings.config))


def _ppo(preset: str) -> Callable[[Settings, int], Trained]:
    def train(settings: Settings, seed: int) -> Trained:
        from gym_babble.study.ppo import one_thread, train_ppo  # noqa: PLC0415 - it loads PyTorch

        ppo = train_ppo(
            preset,
            config=settings.config,
            seed=seed,
            steps=settings.ppo_steps,
            validation_cases=VALIDATION_CASES,
            progress_bar=settings.progress_bar,
        )
        steps = ppo.control_steps // ppo.agent.num_timesteps
        return Trained(
            agent=ppo.agent,
            env_id=ppo.env_id,
            env_kwargs=ppo.env_kwargs,
            movements=ppo.movements,
            control_steps=ppo.control_steps,
            seconds=ppo.seconds,
            curve=tuple(CurvePoint(p.steps * steps, p.seconds, p.success) for p in ppo.curve),
            while_acting=one_thread,
        )

    return train


def _untaught(
    make: Callable[[Any, int], Agent], env_id: str = PATTERN
) -> Callable[[Settings, int], Trained]:
    """An agent made of an environment and a seed, which needs no learning."""

    def train(settings: Settings, seed: int) -> Trained:
        return Trained(
            agent=make(gymnasium.make(env_id, config=settings.config), seed), env_id=env_id
        )

    return train


CONTENDERS = {
    "reach": (
        Contender("hebb-paper", "Hebb paper", "obstacle only", _hebb("paper")),
        Contender("hebb-conjunctive", "Hebb conjunctive", "obstacle × eye", _hebb("conjunctive")),
        Contender("ppo-obstacle", "PPO pattern", "obstacle only", _ppo("pattern_obstacle")),
        Contender("ppo-pattern", "PPO pattern", "all senses", _ppo("pattern")),
        Contender(
            "ppo-posture", "PPO delta_posture", "all senses", _ppo("delta_posture"), slow_test=True
        ),
        Contender(
            "random",
            "Random",
            "babbles on",
            _untaught(lambda env, seed: RandomBabbling(env, seed=seed)),
        ),
        Contender(
            "scripted", "Scripted", "to the shoulder", _untaught(lambda env, _: Scripted(env))
        ),
        Contender(
            "oracle",
            "Oracle",
            "tries 99",
            _untaught(lambda env, _: Oracle(env, threads=os.cpu_count() or 1)),
            slow_test=True,
        ),
    ),
    "grasp": (
        Contender("hebb-paper", "Hebb paper", "eye, fovea", _hebb_grasping, slow_test=True),
        Contender("ppo-stored", "PPO delta_posture", "stored study", None),
        Contender(
            "ppo-posture",
            "PPO delta_posture",
            "all senses",
            _ppo("grasp"),
            slow_test=True,
            asked_for=True,
        ),
        Contender(
            "scripted",
            "Scripted",
            "knows geometry",
            _untaught(lambda env, _: GraspScripted(env), GRASPING),
            slow_test=True,
        ),
        Contender(
            "random",
            "Random",
            "any action",
            _untaught(lambda env, seed: GraspRandom(env, seed=seed), GRASPING),
            slow_test=True,
        ),
    ),
}
"""The rows of each task, in their order."""
