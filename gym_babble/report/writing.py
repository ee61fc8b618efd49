"""Writes the report of a study: a page, its numbers, its tables and its charts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gym_babble.files import write_files
from gym_babble.report import texts
from gym_babble.report.charts import final_charts, learning_charts
from gym_babble.report.citation import bibtex
from gym_babble.report.data import AXES, tasks_of
from gym_babble.report.document import document_of
from gym_babble.report.rendering import drawn, environment, page, picture
from gym_babble.report.sections import sections_of
from gym_babble.report.tables import TABLES, csv_tables, run_rows
from gym_babble.study.statistics import scipy_stats
from gym_babble.study.tasks import task_named
from gym_babble.viz.style import check_format, svg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.report.charts import Chart
    from gym_babble.report.data import TaskRuns
    from gym_babble.report.joined import JoinedRuns
    from gym_babble.study.store import Store

__all__ = ["REPORT_FILES", "write_report"]

REPORT_FILES = ("index.html", "results.json", *TABLES)
"""Names of the files of each report; its charts come beside them, as SVG files."""


def write_report(
    store: Store, folder: Path, command: str, joined: Sequence[JoinedRuns] = ()
) -> list[Path]:
    """Writes index.html, results.json, the tables as CSV and the charts as SVG: all or none.

    Everything comes from the store and the logs that join it: the same ones give the same bytes.

    Args:
        store: The folder of the study; unfinished ones have a report too.
        folder: Folder of the report; created if missing.
        command: The command that creates this report.
        joined: Learning curves of someone's own runs, as `read_joined` reads them.

    Returns:
        The files.

    Raises:
        MissingExtraError: Jinja2, matplotlib or SciPy is not installed.
        FileNotFoundError: The store is not the folder of a study.
        StudyError: A file of the store cannot be read.
        OSError: The files cannot be written; an earlier report is whole.
    """
    _check_extras(folder)
    tasks = tasks_of(store)
    document = document_of(store, tasks, joined)
    book = _Charts()
    shown = [
        _task(task, numbers, book) for task, numbers in zip(tasks, document["tasks"], strict=True)
    ]
    listed = {**document, "files": sorted(book.files)}
    files: dict[str, bytes | str] = {
        "index.html": page(_content(document, shown, command)),
        "results.json": json.dumps(listed, indent=1) + "\n",
        **csv_tables(document),
        **book.files,
    }
    stale = _files_of_earlier(folder) - files.keys()
    return write_files(folder, files, stale=sorted(stale))


def _check_extras(folder: Path) -> None:
    """Raises `MissingExtraError` now, and not when all charts are drawn."""
    environment()
    scipy_stats()
    check_format(folder / "chart.svg")


class _Charts:
    """Draws each chart once, for the page and as a file."""

    def __init__(self) -> None:
        self.files: dict[str, bytes] = {}

    def drawn(self, charts: Sequence[Chart]) -> list[dict[str, Any]]:
        """The charts for the page."""
        shown = []
        for chart in charts:
            data = svg(chart.figure)
            self.files[f"{chart.name}.svg"] = data
            shown.append(drawn(chart, data))
        return shown


def _task(task: TaskRuns, numbers: dict[str, Any], book: _Charts) -> dict[str, Any]:
    """A task for `task.html`: its numbers, sentences, charts and sections."""
    words = task_named(numbers["task"])
    learners = [agent for agent in numbers["agents"] if agent["curve"]] + numbers["joined"]
    charts = {}
    if numbers["agents"]:
        charts = {"final": final_charts(numbers), "learning": learning_charts(numbers)}
    return {
        **numbers,
        "title": texts.title_of_task(numbers),
        "about": texts.about(numbers),
        "warnings": texts.task_warnings(numbers),
        "notes": texts.notes(numbers),
        "trials": words.trials,
        "accepted": words.accepted,
        "axes": [
            {"name": axis, "words": texts.axis_words(numbers, axis)}
            for axis in sorted(AXES, key=lambda axis: axis != "control_steps")
            if any(axis in agent["budgets"] for agent in learners)
        ],
        "learners": learners,
        "sizes": list(numbers["agents"][0]["sizes"]) if numbers["agents"] else [],
        "figures": {name: book.drawn(these) for name, these in charts.items()},
        "shown": [
            {
                **section,
                "panels": book.drawn(section["panels"]),
                "broad": book.drawn(section["broad"]),
                "photos": [picture(*photo) for photo in section["photos"]],
                "legend": numbers["agents"] if section["legend"] else [],
            }
            for section in sections_of(task)
        ],
    }


def _content(document: dict[str, Any], tasks: list[dict[str, Any]], command: str) -> dict[str, Any]:
    """The variables of `page.html`."""
    runs = run_rows(document["tasks"])
    return {
        "title": document["title"],
        "lead": texts.lead(document["tasks"]),
        "warnings": texts.warnings(document["tasks"], document["unfit"]),
        "tasks": tasks,
        "runs": runs,
        "unfit": document["unfit"],
        "methods": texts.methods(document),
        "command": command,
        "made": texts.made(document),
        "study": json.dumps(document["study"], indent=1),
        "bibtex": bibtex(),
    }


def _files_of_earlier(folder: Path) -> set[str]:
    """The charts of an earlier report in the folder, as its results.json lists them."""
    try:
        listed = json.loads((folder / "results.json").read_text(encoding="utf-8"))["files"]
    except (OSError, ValueError, KeyError, TypeError):
        return set()
    return {name for name in listed if isinstance(name, str) and Path(name).name == name}
