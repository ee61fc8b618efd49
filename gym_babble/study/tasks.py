"""The two tasks: how each is tested, and which rates its tables show."""

from __future__ import annotations

from dataclasses import dataclass

from gym_babble.envs.registration import ENVIRONMENTS
from gym_babble.errors import ConfigError

__all__ = ["GRASP", "REACH", "TASKS", "Task", "task_of"]


@dataclass(frozen=True, kw_only=True)
class Task:
    """What a comparison or an evaluation needs to know of a task."""

    name: str
    """Name for `--task`."""
    title: str
    protocol: str
    """Its tests, from `scenarios`."""
    cases: str
    """What tables call them."""
    outcomes: tuple[str, ...]
    """How an episode can end; each has exactly one."""
    facts: tuple[str, ...] = ()
    """What else may be true at the end of an episode."""
    made: str
    """What babbling makes ..."""
    good: str
    """... and what those that are learnt from are called."""
    paper: dict[str, int] | None = None
    """The paper's counts of outcomes on such cases."""


REACH = Task(
    name="reach",
    title="Reaching",
    protocol="table1",
    cases="cases of Table I",
    outcomes=("success", "collision", "joint_limit", "timeout"),
    made="movements",
    good="legal",
    # Table I: counts of 1,000 tests. Of its babbled movements about .20 were legal.
    paper={"success": 670, "collision": 228, "joint_limit": 102, "timeout": 0},
)

GRASP = Task(
    name="grasp",
    title="Grasping",
    protocol="palm_side",
    cases="objects on the palm's side",
    # Without an obstacle nothing collides.
    outcomes=("success", "lost", "timeout"),
    facts=("reach", "palm_reach"),
    made="babbles",
    good="kept",
)

TASKS = {task.name: task for task in (REACH, GRASP)}
"""The tasks by name."""


def task_of(env_id: str) -> Task:
    """The task of a registered environment.

    Raises:
        ConfigError: There is no such environment.
    """
    for row in ENVIRONMENTS:
        if row.id == env_id:
            return TASKS[row.task]
    known = ", ".join(row.id for row in ENVIRONMENTS)
    raise ConfigError(f"{env_id!r} is not an environment; there are {known}")
