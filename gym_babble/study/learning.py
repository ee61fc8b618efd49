"""What an agent's learning took, and its learning curve."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, NamedTuple

from gym_babble.study.evaluation import evaluate
from gym_babble.study.scenarios import scenarios
from gym_babble.study.tasks import task_of

if TYPE_CHECKING:
    from collections.abc import Callable, Collection
    from contextlib import AbstractContextManager

    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike

__all__ = ["VALIDATION_CASES", "CurvePoint", "CurveRecorder", "Learning", "Trained"]

VALIDATION_CASES = 200
"""Cases behind each point of a learning curve."""


class CurvePoint(NamedTuple):
    """One point of a learning curve."""

    control_steps: int
    """Control steps simulated up to this point."""
    seconds: float
    """Clock time of learning without validation [s]."""
    success: float
    """Success rate on 200 validation cases."""


@dataclass(frozen=True, kw_only=True)
class Learning:
    """The cost of learning."""

    trials: int = 0
    """Movements or babbles made, or episodes that ended, during learning."""
    accepted: int | None = None
    """Trials that a Hebb agent learnt from: legal movements, or kept babbles."""
    control_steps: int = 0
    """Control steps simulated; a movement or babble counts with all its steps."""
    seconds: float = 0.0
    """Clock time of learning [s]."""
    curve: tuple[CurvePoint, ...] = ()
    """Success during learning."""


@dataclass(frozen=True, kw_only=True)
class Trained(Learning):
    """An agent that has learnt, its environment, and the cost of learning."""

    agent: Agent
    env_id: str
    while_acting: Callable[[], AbstractContextManager[None]] = nullcontext
    """Makes the context in which the agent is tested."""


class CurveRecorder:
    """Records clock time and learning curve of an agent while it babbles.

    Args:
        env_id: Environment of the agent.
        config: Body and task.
        marks: Numbers of accepted trials at which to measure success.
        steps: Control steps of a trial.
    """

    def __init__(self, env_id: str, config: ConfigLike, marks: Collection[int], steps: int) -> None:
        protocol = task_of(env_id).protocol
        self._cases = scenarios(protocol, VALIDATION_CASES, split="validation", config=config)
        self._env_id = env_id
        self._marks, self._steps = marks, steps
        self._began = perf_counter()
        self.seconds = 0.0
        self.curve: list[CurvePoint] = []

    def note(self, agent: Agent, trials: int, accepted: int) -> None:
        """Records progress; call it during learning."""
        self.seconds += perf_counter() - self._began
        if accepted in self._marks:
            test = evaluate(agent, cases=self._cases)
            point = CurvePoint(trials * self._steps, self.seconds, test.rate("success"))
            self.curve.append(point)
        self._began = perf_counter()

    def trained(self, agent: Agent, trials: int, accepted: int) -> Trained:
        """The agent after learning, with the recorded cost."""
        return Trained(
            agent=agent,
            env_id=self._env_id,
            trials=trials,
            accepted=accepted,
            control_steps=trials * self._steps,
            seconds=self.seconds,
            curve=tuple(self.curve),
        )
