"""The agents of a comparison, and how each learns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import gymnasium

from gym_babble.agents import HebbBabbling, Oracle, Random, Scripted
from gym_babble.agents.loading import own_agent, own_class
from gym_babble.study.learning import CurveRecorder, Trained
from gym_babble.study.roster import ROSTER, trainer_for
from gym_babble.study.trainers.base import Order

if TYPE_CHECKING:
    from collections.abc import Callable

    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike

__all__ = ["CONTENDERS", "Contender", "Settings", "own_contender"]

PATTERN = "BabbleReachPattern-v0"

GRASPING = "BabbleGrasp-v0"

# Accepted trials at which a curve has a point; multiples of an agent's learning step.
LEGAL_MOVEMENTS = (250, 500, 1_000, 2_000, 5_000, 10_000, 20_000)

VALIDATIONS = 10
"""Points of PPO's curve."""

KEPT_BABBLES = (50, 100, 250, 500, 1_000)


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Settings of a comparison."""

    task: str = "reach"
    """Task, "reach" or "grasp"."""
    config: ConfigLike = "paper"
    """Body and task."""
    seed: int = 0
    """First seed of learning and tests."""
    seeds: int = 1
    """Number of seeds: `seed`, `seed` + 1, ..."""
    cases: int = 1_000
    """Tests for each seed."""
    movements: int = 20_000
    """Legal movements that the Hebb agents of reaching learn from."""
    babbles: int = 1_000
    """Babbles that the Hebb agent of grasping learns from."""
    ppo_steps: int | None = None
    """Control steps that PPO learns from; the roster's by default."""
    progress_bar: bool = False
    """Show progress bars."""

    @property
    def all_seeds(self) -> tuple[int, ...]:
        """All seeds."""
        return tuple(range(self.seed, self.seed + self.seeds))


@dataclass(frozen=True)
class Contender:
    """One row of the comparison."""

    key: str
    """Name for `--agents`."""
    title: str
    detail: str
    """Its input, or its method."""
    train: Callable[[Settings, int], Trained] | None
    """Trains the agent with a seed; None for the stored study of the task."""
    slow_test: bool = False
    """Show a progress bar for its test."""
    opt_in: bool = False
    """Takes part only if named."""


def _hebb(env_id: str, variant: str = "paper") -> Callable[[Settings, int], Trained]:
    def train(settings: Settings, seed: int) -> Trained:
        agent = HebbBabbling(gymnasium.make(env_id, config=settings.config), variant, seed=seed)
        reaching = env_id == PATTERN
        babbles = settings.movements if reaching else settings.babbles
        marks = LEGAL_MOVEMENTS if reaching else KEPT_BABBLES
        recorder = CurveRecorder(env_id, settings.config, {*marks, babbles}, agent.steps_per_babble)
        agent.learn(
            babbles,
            progress_bar=settings.progress_bar,
            callback=lambda agent: recorder.note(agent, agent.babbled, agent.learnt),
        )
        return recorder.trained(agent, agent.babbled, agent.learnt)

    return train


def _ppo(name: str) -> Callable[[Settings, int], Trained]:
    def train(settings: Settings, seed: int) -> Trained:
        place = ROSTER[name].tasks[settings.task]
        budget = settings.ppo_steps or place.budget
        order = Order(task=settings.task, seed=seed, budget=budget, config=settings.config)
        trainer = trainer_for(name, order)
        recorder = CurveRecorder(place.env_id, settings.config, range(1, VALIDATIONS + 1), 1)
        passed = 0

        def pause() -> None:
            nonlocal passed
            before, done = passed, trainer.cost.control_steps
            passed = min(VALIDATIONS, done * VALIDATIONS // budget)
            recorder.note(trainer.agent, done, passed if passed > before else 0)

        trainer.train(budget, pause)
        return Trained(
            agent=trainer.agent,
            env_id=place.env_id,
            trials=trainer.cost.trials,
            control_steps=trainer.cost.control_steps,
            seconds=recorder.seconds,
            curve=tuple(recorder.curve),
        )

    return train


def _without_learning(
    make: Callable[[Any, int], Agent], env_id: str = PATTERN
) -> Callable[[Settings, int], Trained]:
    """For an agent that is made from an environment and a seed and does not learn."""

    def train(settings: Settings, seed: int) -> Trained:
        return Trained(
            agent=make(gymnasium.make(env_id, config=settings.config), seed), env_id=env_id
        )

    return train


CONTENDERS = {
    "reach": (
        Contender("hebb-paper", "Hebb paper", "obstacle only", _hebb(PATTERN)),
        Contender(
            "hebb-conjunctive", "Hebb conjunctive", "obstacle × eye", _hebb(PATTERN, "conjunctive")
        ),
        Contender("ppo-obstacle", "PPO pattern", "obstacle only", _ppo("ppo-obstacle")),
        Contender("ppo-pattern", "PPO pattern", "all senses", _ppo("ppo-pattern")),
        Contender("ppo-posture", "PPO delta_posture", "all senses", _ppo("ppo"), slow_test=True),
        Contender(
            "random",
            "Random",
            "babbles",
            _without_learning(lambda env, seed: Random(env, seed=seed)),
        ),
        Contender(
            "scripted",
            "Scripted",
            "to the shoulder",
            _without_learning(lambda env, _: Scripted(env)),
        ),
        Contender(
            "oracle",
            "Oracle",
            "tries 99",
            _without_learning(lambda env, _: Oracle(env, threads=None)),
            slow_test=True,
        ),
    ),
    "grasp": (
        Contender("hebb-paper", "Hebb paper", "eye, fovea", _hebb(GRASPING), slow_test=True),
        Contender("ppo-stored", "PPO delta_posture", "stored study", None),
        Contender(
            "ppo-posture",
            "PPO delta_posture",
            "all senses",
            _ppo("ppo"),
            slow_test=True,
            opt_in=True,
        ),
        Contender(
            "scripted",
            "Scripted",
            "knows geometry",
            _without_learning(lambda env, _: Scripted(env), GRASPING),
            slow_test=True,
        ),
        Contender(
            "random",
            "Random",
            "any action",
            _without_learning(lambda env, seed: Random(env, seed=seed), GRASPING),
            slow_test=True,
        ),
    ),
}
"""The agents of each task, in the order of the table."""


def own_contender(name: str, task: str) -> Contender:
    """An agent of a user's own, by `module:Class`, which does not learn here.

    It acts in its class's `env`, an id, or else where the task's Hebb agents act.
    """
    named = getattr(own_class(name), "env", None)
    env_id = named if isinstance(named, str) else {"reach": PATTERN, "grasp": GRASPING}[task]
    make = _without_learning(lambda env, seed: own_agent(name, env, seed=seed), env_id)
    module, _, cls = name.partition(":")
    return Contender(name, cls, module, make, slow_test=True)
