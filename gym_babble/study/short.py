"""The short form of a study: one task, the roster's agents, `gym-babble compare`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gym_babble.checks import check_choice
from gym_babble.study.roster import ROSTER
from gym_babble.study.spec import study_of
from gym_babble.study.tasks import TASKS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.config import ConfigLike
    from gym_babble.study.spec import Study

__all__ = ["comparison", "usual_agents"]


def comparison(
    task: str = "reach",
    agents: Sequence[str] | None = None,
    *,
    seed: int = 0,
    seeds: int = 1,
    cases: int = 1_000,
    case_seed: int = 1_000,
    budget: int | None = None,
    config: ConfigLike = "paper",
) -> Study:
    """A study of one task on its own test cases.

    Args:
        task: "reach" or "grasp".
        agents: Names in the roster, files, or "module:Class"; by default those of `usual_agents`.
        seed: First seed of learning.
        seeds: Number of seeds.
        cases: Test cases, the same for all agents and seeds.
        case_seed: Seed of the cases.
        budget: Control steps that each agent learns from; each agent's own if not given.
        config: Body and task.

    Raises:
        ConfigError: An argument is unknown or out of bounds.
    """
    check_choice("task", task, TASKS)
    if agents is None:
        agents = [name for name, extra in usual_agents(task).items() if extra is None]
    spec = {
        "protocol": TASKS[task].protocol,
        "config": config,
        "cases": cases,
        "case_seed": case_seed,
        "budget": budget,
    }
    return study_of(
        {
            "name": f"compare-{task}",
            "title": f"{TASKS[task].title}: agents compared",
            "tasks": {task: spec},
            "agents": list(dict.fromkeys(agents)),
            "seeds": list(range(seed, seed + seeds)),
        }
    )


def usual_agents(task: str) -> dict[str, str | None]:
    """The agents that learn a task within minutes, or need not learn.

    Each comes with the extra that it needs and that is not installed, or with None.
    """
    rows = {name: row for name, row in ROSTER.items() if task in row.tasks and row.in_compare}
    return {name: row.extra for name, row in rows.items()}
