"""The main job: Hebb babbling against PPO on reaching, beside agents that need no learning.

Each agent learns in the environment it was made for; all of them are tested on the same cases of
Table I. With several seeds, seed s has learners and 1,000 (`cases`) tests of its own.
"""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass
from time import perf_counter
from typing import TYPE_CHECKING, Any

from gym_babble._core import __version__
from gym_babble.config import Config, config_json
from gym_babble.contenders import CONTENDERS, Contender, Settings, Trained
from gym_babble.errors import ConfigError, MissingExtraError
from gym_babble.evaluation import Evaluation, evaluate
from gym_babble.scenarios import scenarios
from gym_babble.tables import paper_tally, plain_table, rate_cells, share, tally

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rich.table import Table

    from gym_babble.scenarios import Scenario

__all__ = ["CONTENDERS", "Comparison", "Result", "Settings", "compare"]


@dataclass(frozen=True)
class Result:
    """A contender's agents and tests, one of each seed."""

    contender: Contender
    trained: tuple[Trained, ...]
    tests: tuple[Evaluation, ...]

    @property
    def pooled(self) -> Evaluation:
        """All tests together."""
        return sum(self.tests, start=Evaluation((), (), ()))

    @property
    def legal_rate(self) -> float | None:
        """Share of the babbled movements that were legal."""
        legal = sum(trained.legal_movements or 0 for trained in self.trained)
        return legal / sum(trained.movements for trained in self.trained) if legal else None

    def mean(self, what: str) -> float:
        """Mean over seeds of a number of `Trained`."""
        return float(sum(getattr(trained, what) for trained in self.trained)) / len(self.trained)

    def to_json(self) -> dict[str, Any]:
        """What there is to know about it, in JSON's types."""
        return {
            "agent": self.contender.key,
            "title": self.contender.title,
            "detail": self.contender.detail,
            "env_id": self.trained[0].env_id,
            "legal_rate": self.legal_rate,
            "test": tally(self.pooled),
            "test_by_seed": [tally(test) for test in self.tests],
            "training_by_seed": [
                {
                    "movements": trained.movements,
                    "legal_movements": trained.legal_movements,
                    "control_steps": trained.control_steps,
                    "seconds": trained.seconds,
                    "curve": [point._asdict() for point in trained.curve],
                }
                for trained in self.trained
            ],
        }


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

    def to_json(self) -> dict[str, Any]:
        """The whole as one document in JSON's types."""
        settings = {k: v for k, v in asdict(self.settings).items() if k != "progress_bar"}
        body = self.settings.body
        return {
            "task": "reach",
            "protocol": "table1",
            "version": __version__,
            **settings,
            "body": str(body)
            if isinstance(body, str | os.PathLike)
            else Config.from_json(config_json(body)).profile,
            "paper": {"legal_rate": 0.2, "test": paper_tally()},
            "agents": [result.to_json() for result in self.results],
            "skipped": [{"agent": key, "reason": why} for key, why in self.skipped.items()],
            "seconds": self.seconds,
        }

    def table(self) -> Table:
        """The table for the terminal, 80 characters wide."""
        n = self.settings.cases * self.settings.seeds
        heads = ["success", "collision", "joint\nlimit", "timeout"]
        table = plain_table(
            f"Reaching: {n:,} cases of Table I, 95 % Wilson intervals",
            ["agent", *heads, "movements\n[dim]legal[/]", "steps\n[dim]10⁶[/]", "clock\n[dim]s[/]"],
            padding=0,
        )
        paper = "[bold]the paper[/]\n[dim]Table I[/]"
        table.add_row(paper, *rate_cells(paper_tally()), "20,000\n[dim]≈.20[/]")
        for result in self.results:
            table.add_row(*_row(result))
        lines = [f"left out: {key}: {why}" for key, why in self.skipped.items()]
        table.caption = "\n".join(lines).replace("[", "\\[") or None
        return table


def _row(result: Result) -> list[str]:
    name = f"[bold]{result.contender.title}[/]\n[dim]{result.contender.detail}[/]"
    cells = [name, *rate_cells(tally(result.pooled))]
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
        agents: Keys of `CONTENDERS`; all if not given.
        settings: What to compare with; the defaults if not given.
        say: Told what comes next.

    Raises:
        ConfigError: A key or a number is not one there is.
        ScenarioError: The body leaves no room for a case.
    """
    settings = settings or Settings()
    contenders = _chosen(agents)
    if settings.seeds < 1 or settings.movements < 1:
        raise ConfigError("seeds and movements must be at least 1")
    began = perf_counter()
    threads = os.cpu_count() or 1
    cases = [
        scenarios("table1", settings.cases, seed, body=settings.body, threads=threads)
        for seed in range(settings.seeds)
    ]
    results: list[Result] = []
    skipped: dict[str, str] = {}
    for i, contender in enumerate(contenders, start=1):
        say(f"[{i}/{len(contenders)}] {contender.title}, {contender.detail}")
        try:
            results.append(_run(contender, settings, cases))
        except MissingExtraError as error:
            skipped[contender.key] = str(error)
            say(f"left out: {error}")
    return Comparison(settings, tuple(results), skipped, perf_counter() - began)


def _chosen(keys: Sequence[str] | None) -> list[Contender]:
    if keys is None:
        return list(CONTENDERS)
    known = {contender.key: contender for contender in CONTENDERS}
    unknown = [key for key in keys if key not in known]
    if unknown or not keys:
        raise ConfigError(f"agents: {unknown} unknown; there are {', '.join(known)}")
    return [known[key] for key in dict.fromkeys(keys)]


def _run(contender: Contender, settings: Settings, cases: Sequence[Sequence[Scenario]]) -> Result:
    trained = tuple(contender.train(settings, seed) for seed in range(settings.seeds))
    bar = settings.progress_bar and contender.slow_test
    tests = []
    for one, its_cases in zip(trained, cases, strict=True):
        with one.while_acting():
            test = evaluate(
                one.agent,
                one.env_id,
                its_cases,
                body=settings.body,
                progress_bar=bar,
                **one.env_kwargs,
            )
        tests.append(test)
    return Result(contender, trained, tuple(tests))
