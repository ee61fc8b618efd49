"""The numbers of a task, as JSON types: what the page, the charts and the tables show."""

from __future__ import annotations

from dataclasses import asdict
from statistics import fmean
from typing import TYPE_CHECKING, Any

from gym_babble.envs.registry import task_entry
from gym_babble.report.compared import improvement_numbers, mcnemar_numbers, profile_numbers
from gym_babble.report.data import AXES
from gym_babble.report.joined import AXIS, joined_numbers
from gym_babble.report.learning import budget_numbers, curve_numbers, ratio_numbers
from gym_babble.study.efficiency import LEVELS
from gym_babble.study.rates import paper_tally
from gym_babble.study.results import test_tally, title_of
from gym_babble.study.statistics import few_seeds, summary
from gym_babble.study.tasks import task_named

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.report.data import AgentRuns, TaskRuns
    from gym_babble.report.joined import JoinedRuns
    from gym_babble.report.learning import Runs
    from gym_babble.study.store import StoredRun

__all__ = ["absent_numbers", "task_numbers"]


def task_numbers(task: TaskRuns, joined: Sequence[JoinedRuns] = ()) -> dict[str, Any]:
    """All numbers of a task.

    Args:
        task: The task.
        joined: Learning curves from elsewhere that join it.
    """
    config = task.spec.config
    protocol = task_entry(task.spec.task).protocols[task.spec.protocol]
    return {
        "name": task.name,
        "task": task.spec.task,
        "outcomes": list(task.task.outcomes),
        "facts": list(task.task.facts),
        "protocol": task.spec.protocol,
        "config": config if isinstance(config, str) else "a config of its own",
        "cases": len(task.agents[0].happened("success")[0]) if task.agents else None,
        "case_seed": task.spec.case_seed if protocol.random else None,
        "checkpoint_cases": task.spec.checkpoint_cases,
        "levels": list(LEVELS),
        "paper": _paper(task),
        "agents": [_agent(task, agent) for agent in task.agents],
        "joined": joined_numbers(joined, task.series),
        "ratios": {axis: _ratios(task, joined, axis) for axis in AXES},
        "profiles": profile_numbers(task.agents),
        "improvement": improvement_numbers(task.agents),
        "mcnemar": mcnemar_numbers(task.agents),
        "absent": [absent_numbers(run) for run in task.absent],
    }


def absent_numbers(run: StoredRun) -> dict[str, Any]:
    """A run that has not run, or failed."""
    return {
        "label": run.spec.agent.label,
        "title": title_of(run.spec.agent, run.spec.task.task)[0],
        "task": run.spec.task_name,
        "seed": run.spec.seed,
        "status": "missing" if run.record is None else "failed",
        "why": run.error or "it has not run",
    }


def _ratios(
    task: TaskRuns, joined: Sequence[JoinedRuns], axis: str
) -> dict[str, dict[str, list[dict[str, Any]]]]:
    """Ratios of costs: to each learner in control steps, to the first alone on other axes."""
    learners: dict[str, Runs] = {one.spec.label: one.curves(axis) for one in task.learners}
    if axis == AXIS:
        learners |= {one.label: one.runs for one in joined}
    return ratio_numbers(learners, list(learners) if axis == AXIS else list(learners)[:1])


def _agent(task: TaskRuns, agent: AgentRuns) -> dict[str, Any]:
    title, detail = agent.title
    place, seeded = agent.place, agent.entry is None or agent.entry.seeded
    tallies = [test_tally(record) for record in agent.records]
    axes = AXES if agent.learns else ()
    return {
        "label": agent.spec.label,
        "agent": agent.spec.agent,
        "title": title,
        "detail": detail,
        "series": agent.series,
        "knows": None if place is None else list(place.knows),
        "sees": None if place is None else place.sees,
        "env": agent.records[0]["env"],
        "options": agent.spec.options,
        "settings": agent.spec.settings,
        "success": asdict(summary(agent.happened("success"))),
        "seeded": seeded,
        "warning": few_seeds(len(agent.seeds)) if seeded else None,
        "rates": {
            name: fmean(tally[name]["rate"] for tally in tallies) for name in task.task.rates
        },
        "sizes": _sizes(tallies),
        "cost": _cost(agent),
        "runs": [_run(run, tally) for run, tally in zip(agent.runs, tallies, strict=True)],
        "curve": {axis: curve_numbers(agent.curves(axis), agent.seeds) for axis in axes},
        "budgets": {axis: budget_numbers(agent.curves(axis)) for axis in axes},
    }


def _sizes(tallies: list[dict[str, Any]]) -> dict[str, dict[str, float]]:
    """Success with objects of each size: mean over the seeds, worst and best seed."""
    found = {}
    for size in tallies[0].get("by_size", {}):
        rates = [tally["by_size"][size]["success"]["rate"] for tally in tallies]
        found[size] = {"mean": fmean(rates), "worst": min(rates), "best": max(rates)}
    return found


def _cost(agent: AgentRuns) -> dict[str, Any]:
    """Means over the seeds of what learning has used."""
    names = (*AXES, "clock_seconds")
    accepted = [record["cost"]["accepted"] for record in agent.records]
    return {
        **{name: fmean(agent.cost(name)) for name in names},
        "accepted": None if None in accepted else fmean(accepted),
    }


def _run(run: StoredRun, tally: dict[str, Any]) -> dict[str, Any]:
    assert run.record is not None
    return {
        "seed": run.spec.seed,
        "rates": {name: tally[name] for name in task_named(run.spec.task.task).rates},
        "cost": run.record["cost"],
        "fingerprint": run.spec.fingerprint,
        "file": None if run.agent is None else run.agent.name,
        "date": run.record["date"],
    }


def _paper(task: TaskRuns) -> dict[str, float] | None:
    """The paper's rates, where the cases are its own tests."""
    if task.task.paper is None or task.spec.protocol != task.task.protocol:
        return None
    tally = paper_tally()
    return {name: tally[name]["rate"] for name in task.task.outcomes}
