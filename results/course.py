"""The published study's numbers for the lessons: `python -m results.course` writes them.

`results.published.run` does so too. A test compares them with the study's runs.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from gym_babble.course.published import FILE
from gym_babble.files import write_file
from gym_babble.study.results import by_agent
from gym_babble.study.roster import ROSTER
from gym_babble.study.store import Store

if TYPE_CHECKING:
    from pathlib import Path

    from gym_babble.study.store import StoredRun

__all__ = ["AGENTS", "numbers", "write"]

AGENTS = {
    "reach": (
        *("hebb-paper", "hebb-conjunctive", "nearest-neighbour", "goal-babbling"),
        *("ppo-obstacle", "ppo-eye-obstacle", "ppo-pattern", "ppo", "sac", "td3"),
    ),
    "grasp": ("hebb-paper", "hebb-chain", "goal-babbling", "ppo", "ppo-reflex", "ppo-in-hand"),
}
"""The agents that the lessons show, by task."""


def numbers(folder: Path) -> dict[str, Any]:
    """What the lessons show of the study in a folder, by task and agent."""
    store = Store(folder)
    runs = store.runs()
    return {
        task: {label: _agent(by_agent(runs, task)[label], task) for label in labels}
        for task, labels in AGENTS.items()
    }


def _agent(runs: list[StoredRun], task: str) -> dict[str, Any]:
    about = ROSTER[runs[0].spec.agent.agent].tasks[task]
    records = [run.record for run in runs if run.record is not None]
    return {
        "sees": about.sees,
        "knows": list(about.knows),
        "runs": [_run(record) for record in records],
    }


def _run(record: dict[str, Any]) -> dict[str, Any]:
    test, checkpoints = record["test"], record["checkpoints"]
    success = str(test["outcomes"].index("success"))

    def rate(outcome: str) -> float:
        return round(outcome.count(success) / len(outcome), 4)

    return {
        "success": rate(test["outcome"]),
        "control_steps": [point["control_steps"] for point in checkpoints],
        "curve": [rate(point["outcome"]) for point in checkpoints],
        "learnt": [point["accepted"] for point in checkpoints],
    }


def write(folder: Path) -> None:
    """Writes the file in the package."""
    text = json.dumps(numbers(folder), ensure_ascii=False, separators=(",", ":"))
    write_file(FILE, text.replace('{"success"', '\n{"success"') + "\n")


if __name__ == "__main__":
    from results.published import FOLDER

    write(FOLDER)
