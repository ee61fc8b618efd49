"""The results of a comparison: as objects, as JSON, and as a table for the terminal."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from gym_babble._core import __version__
from gym_babble.config import Config, config_json
from gym_babble.study.rates import counted, paper_tally, share
from gym_babble.study.tables import plain_table, rate_cells, rate_heads
from gym_babble.study.tasks import TASKS, Task

if TYPE_CHECKING:
    from rich.table import Table

    from gym_babble.study.contenders import Contender, Settings
    from gym_babble.study.evaluation import Evaluation
    from gym_babble.study.learning import Learning, Trained

__all__ = ["Comparison", "Result", "StoredResult", "TrainedResult"]


@dataclass(frozen=True)
class Result:
    """Learning and test rates of a contender."""

    contender: Contender
    task: Task
    env_id: str
    trained: tuple[Learning, ...]
    """Learning of each seed."""
    rates_by_seed: tuple[dict[str, Any], ...]
    """The `tally` of each seed's tests."""

    @property
    def rates(self) -> dict[str, Any]:
        """The `tally` of all tests together."""
        names = (*self.task.outcomes, *self.task.facts)
        counts = {name: sum(rates[name]["count"] for rates in self.rates_by_seed) for name in names}
        return counted(counts, sum(rates["cases"] for rates in self.rates_by_seed))

    @property
    def accepted_rate(self) -> float | None:
        """Share of the babbled movements that were legal, or of the babbles that were kept."""
        accepted = sum(trained.accepted or 0 for trained in self.trained)
        return accepted / sum(trained.trials for trained in self.trained) if accepted else None

    def mean(self, what: str) -> float:
        """Mean over seeds of a field of `Learning`."""
        return float(sum(getattr(trained, what) for trained in self.trained)) / len(self.trained)

    def to_json(self) -> dict[str, Any]:
        """The result as JSON types."""
        trials, accepted = self.task.trials, self.task.accepted
        return {
            "agent": self.contender.key,
            "title": self.contender.title,
            "detail": self.contender.detail,
            "env_id": self.env_id,
            f"{accepted}_rate": self.accepted_rate,
            "test": self.rates,
            "test_by_seed": list(self.rates_by_seed),
            "training_by_seed": [
                {
                    trials: trained.trials,
                    f"{accepted}_{trials}": trained.accepted,
                    "control_steps": trained.control_steps,
                    "seconds": trained.seconds,
                    "curve": [point._asdict() for point in trained.curve],
                }
                for trained in self.trained
            ],
        }


@dataclass(frozen=True)
class TrainedResult(Result):
    """A result of agents that were trained and tested in this comparison."""

    trained: tuple[Trained, ...]
    tests: tuple[Evaluation, ...]
    """The tests of each seed."""


@dataclass(frozen=True)
class StoredResult(Result):
    """A result of an earlier study that the package contains."""

    provenance: dict[str, Any]
    """The study's command, config and presets."""

    @property
    def note(self) -> str:
        """The origin of the result, in a sentence."""
        cases = " + ".join(f"{rates['cases']:,}" for rates in self.rates_by_seed)
        return (
            f"{self.contender.title}, {self.contender.detail}: from a stored study on {cases} "
            f"cases, `{self.provenance['command']}`"
        )

    def to_json(self) -> dict[str, Any]:
        """The result as JSON types."""
        return {**super().to_json(), "stored": self.provenance}


@dataclass(frozen=True)
class Comparison:
    """The results of a comparison."""

    settings: Settings
    results: tuple[Result, ...]
    skipped: dict[str, str]
    """Contenders that could not take part, with the reasons."""
    seconds: float
    """Clock time of the whole comparison [s]."""

    def result(self, key: str) -> Result | None:
        """The result of a contender; None if it did not take part."""
        return next((result for result in self.results if result.contender.key == key), None)

    @property
    def task(self) -> Task:
        """The compared task."""
        return TASKS[self.settings.task]

    @property
    def notes(self) -> list[str]:
        """Which contenders were left out and why, and which results are stored."""
        left_out = [f"left out: {key}: {why}" for key, why in self.skipped.items()]
        return left_out + [
            result.note for result in self.results if isinstance(result, StoredResult)
        ]

    def to_json(self) -> dict[str, Any]:
        """The comparison as one document of JSON types."""
        # These have their own place in the document, or concern the other task.
        others = [task.trials for task in TASKS.values() if task != self.task]
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
        """The table for a terminal of 80 characters."""
        task, n = self.task, self.settings.cases * self.settings.seeds
        trials = f"{task.trials}\n[dim]{task.accepted}[/]"
        table = plain_table(
            f"{task.title}: {n:,} {task.cases}, 95 % Wilson intervals",
            ["agent", *rate_heads(task, "\n"), trials, "steps\n[dim]10⁶[/]", "clock\n[dim]s[/]"],
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
    if not result.mean("trials"):
        return cells
    trials = f"{result.mean('trials'):,.0f}"
    if result.accepted_rate is not None:
        accepted = f"{result.mean('accepted'):,.0f}"
        trials = f"{accepted}\n[dim]{share(result.accepted_rate)}[/]"
    steps = f"{result.mean('control_steps') / 1e6:.1f}"
    return [*cells, trials, steps, f"{result.mean('seconds'):.0f}"]
