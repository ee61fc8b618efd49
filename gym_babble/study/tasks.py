"""Both tasks: their tests, and the rates that tables show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gym_babble.envs import registry
from gym_babble.errors import ConfigError

__all__ = ["GRASP", "REACH", "TASKS", "Task", "task_named", "task_of"]


@dataclass(frozen=True, kw_only=True)
class Task:
    """What comparison and evaluation need to know about a task."""

    name: str
    """Name for `--task`."""
    title: str
    """Title of tables and reports."""
    protocol: str
    """Protocol of its tests, for `scenarios`."""
    cases: str
    """What tables call its tests."""
    outcomes: tuple[str, ...]
    """Possible outcomes; an episode has exactly one."""
    facts: tuple[str, ...] = ()
    """Further facts at the end of an episode, each true or false."""
    trials: str
    """What babbling's trials are called."""
    accepted: str
    """What trials that an agent learns from are called."""
    paper: dict[str, int] | None = None
    """The paper's counts of outcomes on such tests."""

    @property
    def rates(self) -> tuple[str, ...]:
        """Names of all outcomes and facts."""
        return (*self.outcomes, *self.facts)


def _tests(task: str) -> dict[str, Any]:
    """The registry's first protocol of a task: the cases that results are reported on."""
    first = next(iter(registry.TASKS[task].protocols.values()))
    return {"protocol": first.name, "cases": first.cases, "outcomes": first.outcomes}


REACH = Task(
    name="reach",
    title="Reaching",
    **_tests("reach"),
    trials="movements",
    accepted="legal",
    # Table I: counts of 1,000 tests. About .20 of the babbled movements were legal.
    paper={"success": 670, "collision": 228, "joint_limit": 102, "timeout": 0},
)

GRASP = Task(
    name="grasp",
    title="Grasping",
    **_tests("grasp"),
    facts=("reach", "palm_reach"),
    trials="babbles",
    accepted="kept",
)

TASKS = {task.name: task for task in (REACH, GRASP)}
"""The tasks by name."""


def task_of(env_id: str) -> Task:
    """The task of a registered environment.

    Raises:
        ConfigError: An unknown environment.
    """
    return task_named(registry.environment(env_id).task)


def task_named(name: str) -> Task:
    """The task of that name.

    Raises:
        ConfigError: A task without tests.
    """
    if name not in TASKS:
        raise ConfigError(f"there are no tests of task {name!r}")
    return TASKS[name]
