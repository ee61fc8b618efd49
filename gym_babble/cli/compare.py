"""`gym-babble compare`."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from gym_babble.cli.arguments import (
    Agents,
    AsJson,
    Babbles,
    Cases,
    ConfigName,
    FirstSeed,
    Movements,
    Seeds,
    TaskName,
)
from gym_babble.cli.output import (
    name_files,
    print_json,
    print_results,
    say,
)
from gym_babble.files import check_folder
from gym_babble.report import REPORT_FILES, write_report
from gym_babble.study.compare import compare as run_comparison
from gym_babble.study.contenders import Settings
from gym_babble.study.tasks import TASKS
from gym_babble.viz.style import check_format

__all__ = ["compare"]


def compare(
    *,
    report: Annotated[
        Path | None, typer.Option(help="Folder for index.html and results.json.")
    ] = None,
    other_report: Annotated[
        str | None, typer.Option(help="Path from the report to the other task's page, for a link.")
    ] = None,
    task: TaskName = "reach",
    agents: Agents = None,
    seed: FirstSeed = 0,
    seeds: Seeds = 1,
    cases: Cases = 1_000,
    movements: Movements = 20_000,
    babbles: Babbles = 1_000,
    config: ConfigName = "paper",
    as_json: AsJson = False,
) -> None:
    """Compare Hebb babbling with PPO, and with agents that need no learning."""
    if report is not None:
        check_folder(report, "--report", REPORT_FILES)
        check_format(report / "figure.svg")  # Fails now if the extra `figures` is missing.
    settings = Settings(
        task=task,
        config=config,
        seed=seed,
        seeds=seeds,
        cases=cases,
        movements=movements,
        babbles=babbles,
        progress_bar=True,
    )
    keys = None if agents is None else [key.strip() for key in agents.split(",")]
    comparison = run_comparison(keys, settings, log=say)
    if as_json:
        print_json(comparison.to_json())
    else:
        print_results(comparison.table())
    say(f"{comparison.seconds:.0f} s")
    if report is not None:
        say("writing the report")
        command = _command(settings, report, agents, other_report)
        name_files(write_report(comparison, report, command, other_report))


def _command(settings: Settings, report: Path, agents: str | None, other_report: str | None) -> str:
    """The command that creates the report again."""
    words = ["gym-babble", "compare", "--task", settings.task, "--report", str(report)]
    words += ["--agents", agents] if agents is not None else []
    words += ["--seed", str(settings.seed), "--seeds", str(settings.seeds)]
    words += ["--cases", str(settings.cases)]
    trials = settings.movements if settings.task == "reach" else settings.babbles
    words += [f"--{TASKS[settings.task].trials}", str(trials), "--config", str(settings.config)]
    words += ["--other-report", other_report] if other_report is not None else []
    return shlex.join(words)
