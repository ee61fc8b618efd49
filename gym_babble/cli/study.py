"""`gym-babble study`."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from threading import Lock
from typing import Annotated, Any

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from gym_babble.cli.arguments import AsJson
from gym_babble.cli.output import messages, name_files, print_json, print_results, say
from gym_babble.files import check_folder
from gym_babble.report.joined import read_joined
from gym_babble.report.writing import REPORT_FILES, write_report
from gym_babble.study.engine import run_study
from gym_babble.study.results import results_json, task_table
from gym_babble.study.run import RunSpec, runs_of
from gym_babble.study.spec import Study, read_study
from gym_babble.study.specs import SPECS
from gym_babble.study.store import Store
from gym_babble.study.tables import plain_table

__all__ = ["Jobs", "StudyBar", "print_study", "run_with_bar", "study"]

study = typer.Typer(help="Run, resume and report a study.", no_args_is_help=True)

Jobs = Annotated[
    int | None, typer.Option(min=1, help="Runs at a time. Default: one for each processor.")
]

Engine = Annotated[
    str, typer.Option(help="local: processes on this machine. ray: the machines of a Ray cluster.")
]
Address = Annotated[
    str | None,
    typer.Option(help="Address of the Ray cluster; auto: the one that this machine is part of."),
]


class StudyBar:
    """Shows on stderr how a study goes on, with the time left."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._shares: dict[str, float] = {}
        self._ended = 0
        self.failed = 0
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:>3.0f} %"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
        )
        self._bar = Progress(*columns, console=messages)

    def begin(self, waiting: Sequence[RunSpec], done: int, unfit: Sequence[str]) -> None:
        """Says what there is, and shows the bar."""
        for sentence in unfit:
            say(f"does not fit the study, left out: {sentence}")
        if done:
            say(f"{done} runs are finished already")
        self._weights = {spec.name: 1 + spec.budget for spec in waiting}
        self._task = self._bar.add_task(f"{len(waiting)} runs", total=sum(self._weights.values()))
        self._bar.start()

    def progress(self, spec: RunSpec, share: float) -> None:
        """Moves the bar."""
        with self._lock:
            self._shares[spec.name] = share
            done = sum(self._weights[name] * share for name, share in self._shares.items())
            self._bar.update(self._task, completed=done)

    def end(self, spec: RunSpec, record: dict[str, Any]) -> None:
        """Prints how a run ended."""
        self.progress(spec, 1.0)
        if record["status"] == "failed":
            self.failed += 1
            say(f"{spec.name}: failed: {record['error']}")
        else:
            test = record["test"]
            hits = test["outcome"].count(str(test["outcomes"].index("success")))
            say(f"{spec.name}: success {hits / len(test['outcome']):.3f}")

    def close(self) -> None:
        """Removes the bar."""
        self._bar.stop()


def run_with_bar(
    study: Study,
    folder: Path,
    jobs: int | None,
    engine: str = "local",
    address: str | None = None,
) -> Store:
    """Runs what is missing of a study, and shows how it goes on."""
    bar = StudyBar()
    try:
        return run_study(study, folder, bar, jobs=jobs, engine=engine, address=address)
    finally:
        bar.close()


@study.command("run")
def run(
    spec: Annotated[
        str, typer.Argument(help="TOML or JSON file, or a name that `study list` shows.")
    ],
    *,
    folder: Annotated[Path, typer.Option("--out", help="Folder of the study.")],
    jobs: Jobs = None,
    engine: Engine = "local",
    address: Address = None,
) -> None:
    """Run a study, or what is missing of it: each finished run is stored at once."""
    _run(read_study(spec), folder, jobs, engine, address)


@study.command("resume")
def resume(
    folder: Annotated[Path, typer.Argument(help="Folder of the study.")],
    *,
    jobs: Jobs = None,
    engine: Engine = "local",
    address: Address = None,
) -> None:
    """Go on with the study in a folder."""
    _run(Store(folder).study(), folder, jobs, engine, address)


@study.command("show")
def show(
    folder: Annotated[Path, typer.Argument(help="Folder of the study.")], *, as_json: AsJson = False
) -> None:
    """Print the results of a study, as far as it has come."""
    print_study(Store(folder), as_json=as_json)


@study.command("report")
def report(
    folder: Annotated[Path, typer.Argument(help="Folder of the study.")],
    *,
    out: Annotated[Path, typer.Option(help="Folder for the page, its numbers and charts.")],
    join: Annotated[
        list[str] | None,
        typer.Option(
            metavar="TASK:LABEL=PATH",
            help="Logs of stable-baselines3 whose learning curves join: evaluations.npz, "
            "monitor.csv, a run's folder, or a folder of such folders, one for each seed.",
        ),
    ] = None,
    steps_per_action: Annotated[
        int, typer.Option(min=1, help="Control steps of one step of the joined runs.")
    ] = 1,
) -> None:
    """Write a study as a page, with its numbers as JSON and CSV and its charts as SVG."""
    check_folder(out, "--out", REPORT_FILES)
    store = Store(folder)
    found = store.study()
    joined = [read_joined(one, found, steps_per_action) for one in join or ()]
    words = ["gym-babble", "study", "report", str(folder), "--out", str(out)]
    for one in join or ():
        words += ["--join", one]
    if steps_per_action != 1:
        words += ["--steps-per-action", str(steps_per_action)]
    say("writing the report")
    name_files(write_report(store, out, shlex.join(words), joined))


@study.command("list")
def list_studies() -> None:
    """List the studies that come with the package."""
    table = plain_table(None, ["study", "title", "tasks", "agents", "runs"], left=3)
    for name in SPECS:
        found = read_study(name)
        many = str(len(found.agents)), str(len(runs_of(found)))
        table.add_row(name, found.title, ", ".join(found.tasks), *many)
    print_results(table)


def _run(study: Study, folder: Path, jobs: int | None, engine: str, address: str | None) -> None:
    store = run_with_bar(study, folder, jobs, engine, address)
    print_study(store)
    if not all(run.finished for run in store.runs()):
        raise typer.Exit(1)


def print_study(store: Store, *, as_json: bool = False) -> None:
    """Prints the results of a study: a table for each task, or one JSON document."""
    found, runs = store.study(), store.runs()
    if as_json:
        print_json(results_json(found, runs))
        return
    for name in found.tasks:
        print_results(task_table(found, runs, name))
