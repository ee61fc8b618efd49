"""The results of a study's runs, in the form of `tally`, and as tables for the terminal."""

from __future__ import annotations

from collections import Counter
from statistics import fmean
from typing import TYPE_CHECKING, Any

from gym_babble.study.rates import counted, over_seeds, paper_tally, sizes_of
from gym_babble.study.roster import ROSTER
from gym_babble.study.tables import (
    INTERVALS,
    plain_table,
    rate_cells,
    rate_heads,
    rate_rows,
    stacked,
)
from gym_babble.study.tasks import task_named

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rich.table import Table
    from rich.text import Text

    from gym_babble.study.spec import Study, StudyAgent
    from gym_babble.study.store import StoredRun
    from gym_babble.study.tasks import Task

__all__ = ["by_agent", "results_json", "task_table", "test_tally", "title_of"]


def test_tally(record: Mapping[str, Any]) -> dict[str, Any]:
    """The test of a finished run in the form of `tally`."""
    test = record["test"]
    chosen = range(len(test["outcome"]))
    of_size = [
        (size, [i for i in chosen if test["size"][i] == str(k)])
        for k, size in enumerate(test["sizes"])
    ]
    split = {size: counted(_counts(test, which)) for size, which in of_size}
    return {**counted(_counts(test, chosen)), **({"by_size": split} if split else {})}


def _counts(test: Mapping[str, Any], which: Sequence[int]) -> dict[str, int]:
    found = Counter(test["outcome"][i] for i in which)
    outcomes = {name: found[str(k)] for k, name in enumerate(test["outcomes"])}
    facts = {name: sum(values[i] == "1" for i in which) for name, values in test["facts"].items()}
    return {"cases": len(which), **outcomes, **facts}


def results_json(study: Study, runs: Sequence[StoredRun]) -> dict[str, Any]:
    """The rates and costs of all runs as JSON types, for each task and agent.

    Rates over seeds are means and ranges; a run that failed or is missing has an `error`.
    """
    tasks = {
        name: {
            "protocol": task.protocol,
            "agents": {
                label: _agent_json(task_named(task.task), of_agent)
                for label, of_agent in by_agent(runs, name).items()
            },
        }
        for name, task in study.tasks.items()
    }
    return {"study": study.to_json(), "tasks": tasks}


def _agent_json(task: Task, runs: Sequence[StoredRun]) -> dict[str, Any]:
    records = [run.record for run in runs if run.finished and run.record is not None]
    tallies = [test_tally(record) for record in records]
    sizes = {size: over_seeds(parts, task.rates) for size, parts in sizes_of(tallies).items()}
    costs = [record["cost"] for record in records]
    known = [name for name in (costs[0] if costs else {}) if costs[0][name] is not None]
    return {
        "title": title_of(runs[0].spec.agent, task.name)[0],
        "env": records[0]["env"] if records else None,
        "budget": runs[0].spec.budget,
        "test": {**over_seeds(tallies, task.rates), "by_size": sizes} if tallies else None,
        "cost": {name: fmean(cost[name] for cost in costs) for name in known},
        "by_seed": [_run_json(run) for run in runs],
    }


def _run_json(run: StoredRun) -> dict[str, Any]:
    if not run.finished or run.record is None:
        return {"seed": run.spec.seed, "error": run.error or "has not run"}
    return {"seed": run.spec.seed, "cost": run.record["cost"], **test_tally(run.record)}


def by_agent(runs: Sequence[StoredRun], task_name: str) -> dict[str, list[StoredRun]]:
    """The runs of a task for each agent's label."""
    found: dict[str, list[StoredRun]] = {}
    for run in runs:
        if run.spec.task_name == task_name:
            found.setdefault(run.spec.agent.label, []).append(run)
    return found


def title_of(agent: StudyAgent, task: str) -> tuple[str, str]:
    """Title of an agent, and what it sees in a task, or its name where it has another label."""
    entry = ROSTER.get(agent.agent)
    if entry is None:
        return agent.label, agent.agent
    if agent.label != agent.agent:
        return agent.label, entry.title
    return entry.title, entry.tasks[task].sees


def task_table(study: Study, runs: Sequence[StoredRun], task_name: str) -> Table:
    """The rates of all agents of a task, for a terminal of 80 characters."""
    from rich.text import Text

    spec = study.tasks[task_name]
    task = task_named(spec.task)
    table = plain_table(
        f"{task_name}: {task.cases}, seed of the cases {spec.case_seed}",
        [
            *("agent", *rate_heads(task, "\n"), stacked("trials", "learnt")),
            *(stacked("steps", "10⁶"), stacked("CPU", "s")),
        ],
        padding=0,
    )
    if task.paper is not None and spec.protocol == task.protocol:
        table.add_row(stacked("the paper", "Table I", "bold"), *rate_cells(paper_tally()))
    notes = [INTERVALS]
    for its_runs in by_agent(runs, task_name).values():
        finished = [run for run in its_runs if run.finished]
        notes += [
            f"{run.spec.name}: {run.error or 'has not run'}" for run in its_runs if not run.finished
        ]
        if finished:
            _add_rows(table, finished)
    table.caption = Text("\n".join(notes))
    return table


def _add_rows(table: Table, runs: Sequence[StoredRun]) -> None:
    """The rows of an agent; only the first says what it has learnt from."""
    task = task_named(runs[0].spec.task.task)
    records = [run.record for run in runs if run.record is not None]
    rows = rate_rows([test_tally(one) for one in records], [run.spec.seed for run in runs], task)
    costs = [one["cost"] for one in records]
    cells: list[str | Text] = []
    if runs[0].spec.budget:
        trials = f"{_mean(costs, 'trials'):,.0f}"
        accepted = costs[0]["accepted"]
        learnt = f"{_mean(costs, 'accepted'):,.0f}" if accepted is not None else ""
        steps = f"{_mean(costs, 'control_steps') / 1e6:.1f}"
        cpu = _mean(costs, "cpu_seconds")
        cells = [stacked(trials, learnt), steps, f"{cpu:.1f}" if cpu < 10 else f"{cpu:.0f}"]
    name = stacked(*title_of(runs[0].spec.agent, task.name), "bold")
    table.add_row(name, *rate_cells(rows[0].rates, task), *cells)
    for row in rows[1:]:
        table.add_row(f"  {row.title}", *rate_cells(row.rates, task))


def _mean(costs: Sequence[Mapping[str, Any]], what: str) -> float:
    return fmean(cost[what] for cost in costs)
