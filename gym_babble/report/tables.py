"""The numbers of a study as CSV files."""

from __future__ import annotations

import csv
from io import StringIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

__all__ = ["TABLES", "csv_tables", "run_rows"]

TABLES = ("rates.csv", "runs.csv", "curves.csv", "budgets.csv")
"""Names of the files."""


def csv_tables(document: Mapping[str, Any]) -> dict[str, str]:
    """The files by name."""
    tasks = document["tasks"]
    learners = [(task, one) for task in tasks for one in (*task["agents"], *task["joined"])]
    rows = (
        [_rates(task, agent) for task in tasks for agent in task["agents"]],
        run_rows(tasks),
        [row for task, agent in learners for row in _curve(task, agent)],
        [row for task, agent in learners for row in _budgets(task, agent)],
    )
    return {name: _csv(table) for name, table in zip(TABLES, rows, strict=True)}


def run_rows(tasks: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """A row for each run, those that failed or are missing too."""
    found: list[dict[str, Any]] = []
    for task in tasks:
        for agent in task["agents"]:
            for run in agent["runs"]:
                success, cost = run["rates"]["success"], run["cost"]
                found.append(
                    {
                        "task": task["name"],
                        "label": agent["label"],
                        "seed": run["seed"],
                        "status": "finished",
                        "success": success["rate"],
                        "low": success["low"],
                        "high": success["high"],
                        **cost,
                        "file": run["file"],
                        "fingerprint": run["fingerprint"],
                        "date": run["date"],
                        "why": None,
                    }
                )
        found += [{k: v for k, v in run.items() if k != "title"} for run in task["absent"]]
    return found


def _rates(task: Mapping[str, Any], agent: Mapping[str, Any]) -> dict[str, Any]:
    """An agent's rates over its seeds, and the mean cost of learning."""
    success = {k: v for k, v in agent["success"].items() if k != "iqm"}
    iqm = agent["success"]["iqm"]
    others = {name: rate for name, rate in agent["rates"].items() if name != "success"}
    return {
        "task": task["name"],
        "label": agent["label"],
        "success_iqm": iqm["estimate"],
        "success_low": iqm["low"],
        "success_high": iqm["high"],
        **{f"success_{name}" if name != "seeds" else name: v for name, v in success.items()},
        **others,
        **agent["cost"],
    }


def _curve(task: Mapping[str, Any], agent: Mapping[str, Any]) -> list[dict[str, Any]]:
    """A row for each checkpoint of each run; an axis's points may be fewer than another's."""
    return [
        {
            "task": task["name"],
            "label": agent["label"],
            "axis": axis,
            "seed": run["seed"],
            "cost": cost,
            "success": success,
        }
        for axis, curve in agent["curve"].items()
        for run in curve["runs"]
        for cost, success in zip(run["cost"], run["success"], strict=True)
    ]


def _budgets(task: Mapping[str, Any], agent: Mapping[str, Any]) -> list[dict[str, Any]]:
    return [
        {
            "task": task["name"],
            "label": agent["label"],
            "axis": axis,
            **{k: v for k, v in cell.items() if k != "seeds"},
            "seeds": len(cell["seeds"]),
        }
        for axis, cells in agent["budgets"].items()
        for cell in cells
    ]


def _csv(rows: list[dict[str, Any]]) -> str:
    """A table with the columns of all its rows; what a row does not have stays empty."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    text = StringIO()
    writer = csv.DictWriter(text, names, lineterminator="\n", restval="")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
