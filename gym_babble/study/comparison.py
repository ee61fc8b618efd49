"""The results of a comparison: as objects, as JSON, and as a table for the terminal."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from gym_babble._core import __version__
from gym_babble.config import Config, config_json
from gym_babble.study.rates import over_seeds, paper_tally, share, sizes_of
from gym_babble.study.tables import (
    INTERVALS,
    plain_table,
    rate_cells,
    rate_heads,
    rate_rows,
    stacked,
)
from gym_babble.study.tasks import TASKS, Task

if TYPE_CHECKING:
    from rich.table import Table
    from rich.text import Text

    from gym_babble.study.contenders import Contender, Settings
    from gym_babble.study.learning import Learning, Trained
    from gym_babble.study.outcomes import Evaluation
    from gym_babble.study.stored import Study
    from gym_babble.study.tables import RateRow

__all__ = ["Comparison", "Result", "StoredResult", "TrainedResult"]


@dataclass(frozen=True)
class Result:
    """Learning and test rates of a contender."""

    contender: Contender
    task: Task
    env_id: str
    seeds: tuple[int, ...]
    """The seeds."""
    trained: tuple[Learning, ...]
    """Learning of each seed."""
    rates_by_seed: tuple[dict[str, Any], ...]
    """The `tally` of each seed's tests."""

    @property
    def rows(self) -> list[RateRow]:
        """The rows of rates: all cases, each size of the objects, each of several seeds."""
        return rate_rows(self.rates_by_seed, self.seeds, self.task)

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
            "test": self._over_seeds(),
            "test_by_seed": [
                {"seed": seed, **rates}
                for seed, rates in zip(self.seeds, self.rates_by_seed, strict=True)
            ],
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

    def _over_seeds(self) -> dict[str, Any]:
        """Means and ranges over the seeds, of all cases and of each size."""
        names = self.task.rates
        split = {
            size: over_seeds(of_size, names)
            for size, of_size in sizes_of(self.rates_by_seed).items()
        }
        return {**over_seeds(self.rates_by_seed, names), **({"by_size": split} if split else {})}


@dataclass(frozen=True)
class TrainedResult(Result):
    """A result of agents that were trained and tested in this comparison."""

    trained: tuple[Trained, ...]
    tests: tuple[Evaluation, ...]
    """The tests of each seed."""


@dataclass(frozen=True)
class StoredResult(Result):
    """A result of an earlier study that the package contains."""

    study: Study
    """The study."""

    @property
    def note(self) -> str:
        """The origin of the result, in a sentence."""
        cases = " + ".join(f"{rates['cases']:,}" for rates in self.rates_by_seed)
        return (
            f"{self.contender.title}, {self.contender.detail}: from a stored study on {cases} "
            f"cases, `{self.study.command}`"
        )

    def to_json(self) -> dict[str, Any]:
        """The result as JSON types."""
        about = {name: value for name, value in vars(self.study).items() if name != "runs"}
        runs = [{"versions": run.versions, "machine": run.machine} for run in self.study.runs]
        return {**super().to_json(), "stored": {**about, "runs": runs}}


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
        """Who was left out and why, where agents of your own act, and which results are stored."""
        notes = [f"left out: {key}: {why}" for key, why in self.skipped.items()]
        for result in self.results:
            if isinstance(result, StoredResult):
                notes.append(result.note)
            elif ":" in result.contender.key:
                notes.append(f"{result.contender.key}: acts in {result.env_id}")
        return notes

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
        task, settings = self.task, self.settings
        from rich.text import Text

        seeds = f"{settings.seeds} seeds of " if settings.seeds > 1 else ""
        table = plain_table(
            f"{task.title}: {seeds}{settings.cases:,} {task.cases}",
            [
                *("agent", *rate_heads(task, "\n"), stacked(task.trials, task.accepted)),
                *(stacked("steps", "10⁶"), stacked("clock", "s")),
            ],
            padding=0,
        )
        if task.paper is not None:
            paper = stacked("the paper", "Table I", "bold")
            table.add_row(paper, *rate_cells(paper_tally()), stacked("20,000", "≈.20"))
        for result in self.results:
            for row in _rows(result):
                table.add_row(*row)
        table.caption = Text("\n".join([INTERVALS, *self.notes]))
        return table


def _rows(result: Result) -> list[list[str | Text]]:
    """The rows of a contender; only the first tells what it has learnt from."""
    first, *rest = result.rows
    name = stacked(result.contender.title, result.contender.detail, "bold")
    rows: list[list[str | Text]] = [[name, *rate_cells(first.rates, result.task)]]
    if result.mean("trials"):
        trials: str | Text = f"{result.mean('trials'):,.0f}"
        if result.accepted_rate is not None:
            accepted = f"{result.mean('accepted'):,.0f}"
            trials = stacked(accepted, share(result.accepted_rate))
        steps = f"{result.mean('control_steps') / 1e6:.1f}"
        rows[0] += [trials, steps, f"{result.mean('seconds'):.0f}"]
    return rows + [[f"  {row.title}", *rate_cells(row.rates, result.task)] for row in rest]
