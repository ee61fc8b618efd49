"""The numbers of a whole study as one document of JSON types: results.json."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.report.numbers import task_numbers
from gym_babble.study.run import runs_of
from gym_babble.study.statistics import CONFIDENCE, RESAMPLES

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from gym_babble.report.data import TaskRuns
    from gym_babble.report.joined import JoinedRuns
    from gym_babble.study.store import Store

__all__ = ["document_of"]


def document_of(
    store: Store, tasks: Sequence[TaskRuns], joined: Sequence[JoinedRuns] = ()
) -> dict[str, Any]:
    """All numbers of a study.

    Args:
        store: The study's folder.
        tasks: Its tasks, as `tasks_of` reads them.
        joined: Learning curves from elsewhere that join them.

    Raises:
        StudyError: A file of the store cannot be read.
    """
    study = store.study()
    records = [record for task in tasks for agent in task.agents for record in agent.records]
    numbers = [
        task_numbers(task, [one for one in joined if one.task == task.name]) for task in tasks
    ]
    return {
        "name": study.name,
        "title": study.title,
        "tasks": numbers,
        "unfit": store.unfit(runs_of(study)),
        "cpu_seconds": sum(record["cost"]["cpu_seconds"] for record in records),
        "statistics": {"resamples": RESAMPLES, "confidence": CONFIDENCE},
        "versions": _versions(records),
        "machines": _different(_machine(record["machine"]) for record in records),
        "physics": _different(record["physics"] for record in records),
        "code": _different(record["code"] for record in records),
        "study": study.to_json(),
    }


def _versions(records: Sequence[dict[str, Any]]) -> dict[str, list[str]]:
    """The versions of each package that runs were made with."""
    names = {name: None for record in records for name in record["versions"]}
    found = {name: _different(record["versions"].get(name) for record in records) for name in names}
    return {name: versions for name, versions in found.items() if versions}


def _machine(machine: dict[str, Any]) -> str:
    return (
        f"{machine['system']} {machine['architecture']}, {machine['processor']}, "
        f"{machine['processors']} processors"
    )


def _different(values: Iterable[str | None]) -> list[str]:
    """Each value once, sorted."""
    return sorted({value for value in values if value is not None})
