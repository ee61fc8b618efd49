"""The published study for the lessons: learning curves and final success of its agents.

`python -m results.course` writes the numbers from the study's runs.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.checks import check_choice

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["FILE", "PublishedAgent", "PublishedRun", "published"]

FILE = Path(__file__).with_suffix(".json")
"""The numbers."""


@dataclass(frozen=True, kw_only=True)
class PublishedRun:
    """One seed of an agent."""

    success: float
    """Share of the 1,000 test cases that it solved in the end."""
    control_steps: NDArray[np.int64]
    """Control steps of learning at each checkpoint (k,), failed movements included."""
    curve: NDArray[np.float64]
    """Share of 200 of the test cases that it solved at each checkpoint (k,)."""
    learnt: NDArray[np.float64]
    """Babbles that it had learnt from at each checkpoint (k,); NaN if it does not babble."""

    def steps_to(self, success: float) -> float:
        """Control steps at the first checkpoint with so much success; infinite if there is none."""
        reached = np.flatnonzero(self.curve >= success)
        return float(self.control_steps[reached[0]]) if len(reached) else np.inf


@dataclass(frozen=True, kw_only=True)
class PublishedAgent:
    """An agent of the study, with all its seeds."""

    sees: str
    """What it decides from."""
    knows: tuple[str, ...]
    """What it is given beforehand."""
    runs: tuple[PublishedRun, ...]
    """A run for each seed."""

    @property
    def success(self) -> NDArray[np.float64]:
        """Final success of each seed (seeds,)."""
        return np.array([run.success for run in self.runs])

    def steps_to(self, success: float) -> NDArray[np.float64]:
        """Control steps of each seed (seeds,) until it had so much success at a checkpoint."""
        return np.array([run.steps_to(success) for run in self.runs])


def published(task: str) -> dict[str, PublishedAgent]:
    """Agents of the published study by their names in it.

    Args:
        task: "reach" or "grasp".

    Raises:
        ConfigError: There is no such task.
    """
    numbers = _numbers()
    agents = numbers[check_choice("task", task, numbers)]
    return {label: _agent(agent) for label, agent in agents.items()}


@cache
def _numbers() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return found


def _agent(agent: dict[str, Any]) -> PublishedAgent:
    return PublishedAgent(
        sees=agent["sees"],
        knows=tuple(agent["knows"]),
        runs=tuple(
            PublishedRun(
                success=run["success"],
                control_steps=np.array(run["control_steps"]),
                curve=np.array(run["curve"]),
                learnt=np.array(run["learnt"], float),
            )
            for run in agent["runs"]
        ),
    )
