"""The runs of a store, by task and agent."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.study.results import title_of
from gym_babble.study.roster import ROSTER
from gym_babble.study.tasks import task_named

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble.study.roster import Place, RosterAgent
    from gym_babble.study.spec import Study, StudyAgent, StudyTask
    from gym_babble.study.store import Store, StoredRun
    from gym_babble.study.tasks import Task

__all__ = ["AXES", "AgentRuns", "TaskRuns", "tasks_of"]

LEAST = {"trials": 1.0, "control_steps": 1.0, "cpu_seconds": 0.001}
"""The smallest cost that counts: logarithmic axes have no 0."""

AXES = tuple(LEAST)
"""What learning costs, as the axes of learning curves."""


@dataclass(frozen=True)
class AgentRuns:
    """The finished runs of an agent on a task."""

    spec: StudyAgent
    series: int
    """Position in the study."""
    task: str
    runs: tuple[StoredRun, ...]

    @property
    def title(self) -> tuple[str, str]:
        """Its title, and a detail."""
        return title_of(self.spec, self.task)

    @property
    def entry(self) -> RosterAgent | None:
        """Its entry in the roster, if it has one."""
        return ROSTER.get(self.spec.agent)

    @property
    def place(self) -> Place | None:
        """Where the roster says that it learns this task."""
        return None if self.entry is None else self.entry.tasks[self.task]

    @property
    def records(self) -> list[dict[str, Any]]:
        """The records of the runs."""
        return [run.record for run in self.runs if run.record is not None]

    @property
    def seeds(self) -> list[int]:
        """The seeds of the runs."""
        return [run.spec.seed for run in self.runs]

    @property
    def learns(self) -> bool:
        """Whether a run has checkpoints."""
        return any(record["checkpoints"] for record in self.records)

    def happened(self, name: str) -> NDArray[np.bool_]:
        """Whether each case of the final test had this outcome or fact (seeds, cases)."""
        return np.array([_happened(record["test"], name) for record in self.records], np.bool_)

    def cost(self, what: str) -> list[float]:
        """What each run has used in all."""
        return [record["cost"][what] for record in self.records]

    def curves(self, axis: str) -> list[tuple[list[float], list[float]]]:
        """Cost and success at the checkpoints of each run.

        Checkpoints at the same cost, as on a clock too coarse for them, count as the last of them.
        """
        found = []
        for record in self.records:
            success = str(record["test"]["outcomes"].index("success"))
            rates = {
                max(float(one[axis]), LEAST[axis]): one["outcome"].count(success)
                / len(one["outcome"])
                for one in record["checkpoints"]
            }
            found.append((list(rates), list(rates.values())))
        return found


@dataclass(frozen=True)
class TaskRuns:
    """The runs of a task, finished or not."""

    name: str
    """Name in the study."""
    spec: StudyTask
    agents: tuple[AgentRuns, ...]
    """The agents with finished runs, in the study's order."""
    absent: tuple[StoredRun, ...]
    """Runs that are missing or failed."""
    series: int
    """Number of agents of the study."""

    @property
    def task(self) -> Task:
        """What the task is called, and what can happen in it."""
        return task_named(self.spec.task)

    @property
    def learners(self) -> list[AgentRuns]:
        """The agents that learnt."""
        return [agent for agent in self.agents if agent.learns]


def tasks_of(store: Store) -> list[TaskRuns]:
    """The tasks of a study with their runs.

    Raises:
        FileNotFoundError: The folder is not a study's.
        StudyError: A file of the store cannot be read.
    """
    study, runs = store.study(), store.runs()
    return [_task(study, name, runs) for name in study.tasks]


def _task(study: Study, name: str, runs: list[StoredRun]) -> TaskRuns:
    mine = [run for run in runs if run.spec.task_name == name]
    task = study.tasks[name]
    agents = []
    for i, agent in enumerate(study.agents):
        its = [run for run in mine if run.spec.agent.label == agent.label and run.finished]
        its.sort(key=lambda run: run.spec.seed)
        if its:
            agents.append(AgentRuns(agent, i, task.task, tuple(its)))
    absent = tuple(run for run in mine if not run.finished)
    return TaskRuns(name, task, tuple(agents), absent, len(study.agents))


def _happened(test: dict[str, Any], name: str) -> list[bool]:
    """Whether each case of a stored test had this outcome or fact."""
    if name in test["facts"]:
        return [digit == "1" for digit in test["facts"][name]]
    index = str(test["outcomes"].index(name))
    return [digit == index for digit in test["outcome"]]
