"""`gym-babble compare`."""

import shlex
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

from gym_babble.cli.arguments import AsJson, Cases, ConfigName, FirstSeed, Seeds, TaskName
from gym_babble.cli.output import name_files, say
from gym_babble.cli.study import Jobs, print_study, run_with_bar
from gym_babble.files import check_folder
from gym_babble.report import REPORT_FILES, write_report
from gym_babble.study.roster import ROSTER
from gym_babble.study.run import runs_of
from gym_babble.study.short import comparison, usual_agents
from gym_babble.viz.style import check_format

__all__ = ["compare"]

STUDY = "study"
"""Folder of the study in that of its report."""


def compare(
    *,
    report: Annotated[
        Path | None, typer.Option(help="Folder for the page and its numbers, and for the study.")
    ] = None,
    task: TaskName = "reach",
    agents: Annotated[
        str | None,
        typer.Option(
            help=f"Agents, with commas between: {', '.join(ROSTER)}, a file, or module:Class. "
            "Default: those that take minutes."
        ),
    ] = None,
    seed: FirstSeed = 0,
    seeds: Seeds = 1,
    cases: Cases = 1_000,
    budget: Annotated[
        int | None,
        typer.Option(min=1, help="Control steps to learn from. Default: each agent's own."),
    ] = None,
    config: ConfigName = "paper",
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> None:
    """Compare agents on one task: the short form of `study`."""
    if report is not None:
        check_folder(report, "--report", REPORT_FILES)
        check_format(report / "figure.svg")  # Fails now if the extra `figures` is missing.
    names = None if agents is None else [name.strip() for name in agents.split(",")]
    if names is None:
        for name, extra in usual_agents(task).items():
            if extra is not None:
                say(f"left out: {name}, which needs pip install 'gym-babble[{extra}]'")
    given = {
        "--report": report,
        "--task": task,
        "--agents": agents,
        "--seed": seed,
        "--seeds": seeds,
        "--cases": cases,
        "--budget": budget,
        "--config": config,
    }
    words = ["gym-babble", "compare"]
    for option, value in given.items():
        words += [] if value is None else [option, str(value)]
    study = comparison(
        task, names, seed=seed, seeds=seeds, cases=cases, budget=budget, config=config
    )
    runs_of(study)  # Names an unknown agent before anything is written.
    with TemporaryDirectory() as aside:
        store = run_with_bar(study, Path(aside) if report is None else report / STUDY, jobs)
        print_study(store, as_json=as_json)
        if report is not None:
            say("writing the report")
            name_files(write_report(store, report, shlex.join(words)))
        if not all(run.finished for run in store.runs()):
            raise typer.Exit(1)
