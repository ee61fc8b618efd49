"""The main job: Hebb babbling against PPO on a task, beside agents that need no learning.

Each agent learns in the environment it was made for; all of them are tested on the same cases:
of reaching those of Table I, of grasping those with the object on the palm's side. With several
seeds, seed s has learners and 1,000 (`cases`) tests of its own.
"""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from gym_babble._core import __version__
from gym_babble.config import Config, config_json
from gym_babble.errors import ConfigError, MissingExtraError, StudyError
from gym_babble.study.contenders import (
    CONTENDERS,
    Contender,
    CurvePoint,
    Learning,
    Settings,
    Trained,
)
from gym_babble.study.evaluation import Evaluation, evaluate
from gym_babble.study.scenarios import scenarios
from gym_babble.study.tables import (
    counted,
    paper_tally,
    plain_table,
    rate_cells,
    rate_heads,
    share,
    tally,
)
from gym_babble.study.tasks import TASKS, Task

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rich.table import Table

    from gym_babble.study.scenarios import GraspScenario, Scenario

__all__ = ["CONTENDERS", "Comparison", "Played", "Result", "Settings", "Stored", "compare"]

STUDIES = Path(__file__).with_name("results")
"""What examples/ppo_study.py wrote."""


@dataclass(frozen=True)
class Result:
    """A contender's learning and the rates of its tests, one of each seed."""

    contender: Contender
    task: Task
    env_id: str
    trained: tuple[Learning, ...]
    rates_by_seed: tuple[dict[str, Any], ...]
    """A `tally` of each seed."""

    @property
    def rates(self) -> dict[str, Any]:
        """The `tally` of all tests together."""
        names = (*self.task.outcomes, *self.task.facts)
        counts = {name: sum(rates[name]["count"] for rates in self.rates_by_seed) for name in names}
        return counted(counts, sum(rates["cases"] for rates in self.rates_by_seed))

    @property
    def legal_rate(self) -> float | None:
        """Share of the babbled movements that were legal, or of the babbles that were kept."""
        legal = sum(trained.legal_movements or 0 for trained in self.trained)
        return legal / sum(trained.movements for trained in self.trained) if legal else None

    def mean(self, what: str) -> float:
        """Mean over seeds of a number of `Learning`."""
        return float(sum(getattr(trained, what) for trained in self.trained)) / len(self.trained)

    def to_json(self) -> dict[str, Any]:
        """What there is to know about it, in JSON's types."""
        made, good = self.task.made, self.task.good
        return {
            "agent": self.contender.key,
            "title": self.contender.title,
            "detail": self.contender.detail,
            "env_id": self.env_id,
            f"{good}_rate": self.legal_rate,
            "test": self.rates,
            "test_by_seed": list(self.rates_by_seed),
            "training_by_seed": [
                {
                    made: trained.movements,
                    f"{good}_{made}": trained.legal_movements,
                    "control_steps": trained.control_steps,
                    "seconds": trained.seconds,
                    "curve": [point._asdict() for point in trained.curve],
                }
                for trained in self.trained
            ],
        }


@dataclass(frozen=True)
class Played(Result):
    """A result of agents that learnt and were tested here."""

    trained: tuple[Trained, ...]
    tests: tuple[Evaluation, ...]


@dataclass(frozen=True)
class Stored(Result):
    """A result that a study found elsewhere, at another time."""

    provenance: dict[str, Any]
    """The study's command, config and presets."""

    @property
    def note(self) -> str:
        """Where it is from, in a sentence."""
        cases = " + ".join(f"{rates['cases']:,}" for rates in self.rates_by_seed)
        return (
            f"{self.contender.title}, {self.contender.detail}: not made here, but on {cases} cases "
            f"by `{self.provenance['command']}`"
        )

    def to_json(self) -> dict[str, Any]:
        """What there is to know about it, in JSON's types."""
        return {**super().to_json(), "stored": self.provenance}


@dataclass(frozen=True)
class Comparison:
    """What came out."""

    settings: Settings
    results: tuple[Result, ...]
    skipped: dict[str, str]
    """Contenders that could not take part, and why."""
    seconds: float
    """Clock time of it all [s]."""

    def result(self, key: str) -> Result | None:
        """The result of a contender, if it took part."""
        return next((result for result in self.results if result.contender.key == key), None)

    @property
    def task(self) -> Task:
        """The task."""
        return TASKS[self.settings.task]

    @property
    def notes(self) -> list[str]:
        """Who was left out and why, and which results were not made here."""
        left_out = [f"left out: {key}: {why}" for key, why in self.skipped.items()]
        return left_out + [result.note for result in self.results if isinstance(result, Stored)]

    def to_json(self) -> dict[str, Any]:
        """The whole as one document in JSON's types."""
        # What has a place of its own, and how much the agents of the other task babble.
        others = [task.made for task in TASKS.values() if task != self.task]
        elsewhere = ("task", "progress_bar", *others)
        settings = {k: v for k, v in asdict(self.settings).items() if k not in elsewhere}
        config = self.settings.config
        paper = {} if self.task.paper is None else {"legal_rate": 0.2, "test": paper_tally()}
        return {
            "task": self.task.name,
            "protocol": self.task.protocol,
            "version": __version__,
            **settings,
            "config": str(config)
            if isinstance(config, str | os.PathLike)
            else Config.from_json(config_json(config)).profile,
            "paper": paper or None,
            "agents": [result.to_json() for result in self.results],
            "skipped": [{"agent": key, "reason": why} for key, why in self.skipped.items()],
            "seconds": self.seconds,
        }

    def table(self) -> Table:
        """The table for the terminal, 80 characters wide."""
        task, n = self.task, self.settings.cases * self.settings.seeds
        made = f"{task.made}\n[dim]{task.good}[/]"
        table = plain_table(
            f"{task.title}: {n:,} {task.cases}, 95 % Wilson intervals",
            ["agent", *rate_heads(task, "\n"), made, "steps\n[dim]10⁶[/]", "clock\n[dim]s[/]"],
            padding=0,
        )
        if task.paper is not None:
            paper = "[bold]the paper[/]\n[dim]Table I[/]"
            table.add_row(paper, *rate_cells(paper_tally()), "20,000\n[dim]≈.20[/]")
        for result in self.results:
            table.add_row(*_row(result))
        table.caption = "\n".join(self.notes).replace("[", "\\[") or None
        return table


def _row(result: Result) -> list[str]:
    name = f"[bold]{result.contender.title}[/]\n[dim]{result.contender.detail}[/]"
    cells = [name, *rate_cells(result.rates, result.task)]
    if not result.mean("movements"):
        return cells
    movements = f"{result.mean('movements'):,.0f}"
    if result.legal_rate is not None:
        legal = f"{result.mean('legal_movements'):,.0f}"
        movements = f"{legal}\n[dim]{share(result.legal_rate)}[/]"
    steps = f"{result.mean('control_steps') / 1e6:.1f}"
    return [*cells, movements, steps, f"{result.mean('seconds'):.0f}"]


def compare(
    agents: Sequence[str] | None = None,
    settings: Settings | None = None,
    *,
    say: Callable[[str], None] = lambda _: None,
) -> Comparison:
    """Trains and tests the contenders one after the other.

    Args:
        agents: Keys of `CONTENDERS` of the task; all that need not be asked for if not given.
        settings: What to compare with; the defaults if not given.
        say: Told what comes next.

    Raises:
        ConfigError: A task, key or number is not one there is.
        ScenarioError: The body leaves no room for a case.
    """
    settings = settings or Settings()
    if settings.task not in TASKS:
        raise ConfigError(f"task = {settings.task!r} is not one of {', '.join(TASKS)}")
    task = TASKS[settings.task]
    contenders = _chosen(agents, task)
    if min(settings.seeds, settings.movements, settings.babbles) < 1:
        raise ConfigError("seeds, movements and babbles must be at least 1")
    began = perf_counter()
    threads = os.cpu_count() or 1
    cases = [
        scenarios(task.protocol, settings.cases, seed, config=settings.config, threads=threads)
        for seed in range(settings.seeds)
    ]
    results: list[Result] = []
    skipped: dict[str, str] = {}
    for i, contender in enumerate(contenders, start=1):
        say(f"[{i}/{len(contenders)}] {contender.title}, {contender.detail}")
        try:
            results.append(_run(contender, task, settings, cases))
        except (MissingExtraError, StudyError) as error:
            skipped[contender.key] = str(error)
            say(f"left out: {error}")
    return Comparison(settings, tuple(results), skipped, perf_counter() - began)


def _chosen(keys: Sequence[str] | None, task: Task) -> list[Contender]:
    known = {contender.key: contender for contender in CONTENDERS[task.name]}
    if keys is None:
        return [contender for contender in known.values() if not contender.asked_for]
    unknown = [key for key in keys if key not in known]
    if unknown or not keys:
        raise ConfigError(f"agents: {unknown} unknown; there are {', '.join(known)}")
    return [known[key] for key in dict.fromkeys(keys)]


def _run(
    contender: Contender,
    task: Task,
    settings: Settings,
    cases: Sequence[Sequence[Scenario | GraspScenario]],
) -> Result:
    if contender.train is None:
        return _stored(contender, task, settings)
    trained = tuple(contender.train(settings, seed) for seed in range(settings.seeds))
    bar = settings.progress_bar and contender.slow_test
    tests = []
    for one, its_cases in zip(trained, cases, strict=True):
        with one.while_acting():
            test = evaluate(
                one.agent,
                one.env_id,
                its_cases,
                config=settings.config,
                progress_bar=bar,
                **one.env_kwargs,
            )
        tests.append(test)
    rates = tuple(tally(test, task) for test in tests)
    return Played(contender, task, trained[0].env_id, trained, rates, tuple(tests))


def _stored(contender: Contender, task: Task, settings: Settings) -> Stored:
    """What the study found, whatever seeds and cases are compared here."""
    study = json.loads((STUDIES / f"ppo_{task.name}.json").read_text(encoding="utf-8"))
    if settings.config != study["config"]:
        raise StudyError(f"the stored study is of config {study['config']}")
    names = (*task.outcomes, *task.facts)
    return Stored(
        contender,
        task,
        env_id=study["presets"][study["runs"][0]["preset"]]["env_id"],
        trained=tuple(_learning(run) for run in study["runs"]),
        rates_by_seed=tuple(
            counted({name: run[name] for name in names}, run["cases"]) for run in study["runs"]
        ),
        provenance={name: value for name, value in study.items() if name != "runs"},
    )


def _learning(run: dict[str, Any]) -> Learning:
    return Learning(
        movements=run["movements"],
        control_steps=run["control_steps"],
        seconds=run["seconds"],
        curve=tuple(CurvePoint(*point) for point in run["curve"]),
    )
