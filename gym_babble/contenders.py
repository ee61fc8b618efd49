"""Who is compared: how each agent learns, and what learning took."""

from __future__ import annotations

import os
from contextlib import nullcontext
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

import gymnasium

from gym_babble.agents import HebbBabbling, Oracle, RandomBabbling, Scripted
from gym_babble.config import Config, config_json
from gym_babble.evaluation import evaluate
from gym_babble.scenarios import scenarios

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from gym_babble.agents.base import Agent
    from gym_babble.config import BodyLike

__all__ = ["CONTENDERS", "Contender", "CurvePoint", "Settings", "Trained"]

PATTERN = "BabbleReachPattern-v0"
VALIDATION_CASES = 200
# Legal movements after which a Hebb agent's curve has a point; multiples of 250, its learning step.
MILESTONES = (250, 500, 1_000, 2_000, 5_000, 10_000, 20_000)


@dataclass(frozen=True, kw_only=True)
class Settings:
    """What a comparison is made with."""

    body: BodyLike = "paper"
    """Body and task."""
    seeds: int = 1
    """Seeds 0, 1, ... of learning and tests."""
    cases: int = 1_000
    """Tests of each seed."""
    movements: int = 20_000
    """Legal movements that the Hebb agents learn from."""
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
class Trained:
    """An agent, where it acts, and what learning took."""

    agent: Agent
    env_id: str = PATTERN
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    movements: int = 0
    """Movements babbled, or episodes ended while it learnt."""
    legal_movements: int | None = None
    """Of these the legal ones, which a Hebb agent learns from."""
    control_steps: int = 0
    """Control steps simulated; a movement counts with its whole length."""
    seconds: float = 0.0
    """Clock time of learning [s]."""
    curve: tuple[CurvePoint, ...] = ()
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
    train: Callable[[Settings, int], Trained]
    slow_test: bool = False
    """Whether its test takes more than a moment."""


class _Course:
    """Keeps clock and learning curve of a Hebb agent while it babbles."""

    def __init__(self, settings: Settings) -> None:
        self._body = settings.body
        self._cases = scenarios("table1", VALIDATION_CASES, split="validation", body=settings.body)
        self._marks = {*MILESTONES, settings.movements}
        self._steps = _movement_steps(settings.body)
        self._began = perf_counter()
        self.seconds = 0.0
        self.curve: list[CurvePoint] = []

    def __call__(self, agent: HebbBabbling) -> None:
        self.seconds += perf_counter() - self._began
        if agent.legal_movements in self._marks:
            success = evaluate(agent, PATTERN, self._cases, body=self._body).rate("success")
            self.curve.append(CurvePoint(agent.movements * self._steps, self.seconds, success))
        self._began = perf_counter()


def _movement_steps(body: BodyLike) -> int:
    return Config.from_json(config_json(body)).movement_steps


def _hebb(variant: str) -> Callable[[Settings, int], Trained]:
    def train(settings: Settings, seed: int) -> Trained:
        env = gymnasium.make(PATTERN, body=settings.body)
        agent = HebbBabbling(env, variant, seed=seed)
        course = _Course(settings)
        agent.learn(settings.movements, progress_bar=settings.progress_bar, callback=course)
        return Trained(
            agent=agent,
            movements=agent.movements,
            legal_movements=agent.legal_movements,
            control_steps=agent.movements * _movement_steps(settings.body),
            seconds=course.seconds,
            curve=tuple(course.curve),
        )

    return train


def _ppo(preset: str) -> Callable[[Settings, int], Trained]:
    def train(settings: Settings, seed: int) -> Trained:
        from gym_babble.ppo import one_thread, train_ppo  # noqa: PLC0415 - it loads PyTorch

        ppo = train_ppo(
            preset,
            body=settings.body,
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


def _random(settings: Settings, seed: int) -> Trained:
    return Trained(agent=RandomBabbling(gymnasium.make(PATTERN, body=settings.body), seed=seed))


def _scripted(settings: Settings, seed: int) -> Trained:
    del seed
    return Trained(agent=Scripted(gymnasium.make(PATTERN, body=settings.body)))


def _oracle(settings: Settings, seed: int) -> Trained:
    del seed
    env = gymnasium.make(PATTERN, body=settings.body)
    return Trained(agent=Oracle(env, threads=os.cpu_count() or 1))


CONTENDERS = (
    Contender("hebb-paper", "Hebb paper", "obstacle only", _hebb("paper")),
    Contender("hebb-conjunctive", "Hebb conjunctive", "obstacle × eye", _hebb("conjunctive")),
    Contender("ppo-obstacle", "PPO pattern", "obstacle only", _ppo("pattern_obstacle")),
    Contender("ppo-pattern", "PPO pattern", "all senses", _ppo("pattern")),
    Contender(
        "ppo-posture", "PPO delta_posture", "all senses", _ppo("delta_posture"), slow_test=True
    ),
    Contender("random", "Random", "babbles on", _random),
    Contender("scripted", "Scripted", "to the shoulder", _scripted),
    Contender("oracle", "Oracle", "tries 99", _oracle, slow_test=True),
)
"""The rows, in their order."""
