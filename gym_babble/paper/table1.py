"""Table I: success, collision and joint-limit rates of reaching."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import gymnasium

from gym_babble.agents import HebbBabbling
from gym_babble.checks import check_seed, check_whole
from gym_babble.errors import ConfigError
from gym_babble.study.evaluation import evaluate
from gym_babble.study.rates import OUTCOMES, over_seeds, paper_tally, spread, tally
from gym_babble.study.scenarios import scenarios

if TYPE_CHECKING:
    from gym_babble.config import ConfigLike
    from gym_babble.study.outcomes import Evaluation

__all__ = ["CONTROLS", "TableOne", "table1"]

CONTROLS = {"pattern": "BabbleReachPattern-v0", "delta_posture": "BabbleReach-v0"}
"""Controls for the tests of Table I, with their environments."""


@dataclass(frozen=True)
class TableOne:
    """Table I over several seeds; each seed has its own babbling and tests."""

    settings: dict[str, Any]
    """The arguments of `table1`."""
    seeds: tuple[int, ...]
    """The seeds."""
    tests: tuple[Evaluation, ...]
    """The tests of each seed."""
    legal_rates: tuple[float, ...]
    """Share of the babbled movements that were legal, for each seed."""

    def to_json(self) -> dict[str, Any]:
        """Rates of each seed, with Wilson intervals over its cases; means and ranges of seeds."""
        by_seed = [tally(test) for test in self.tests]
        paper, rates = paper_tally(), over_seeds(by_seed, OUTCOMES)
        cases = sum(len(test) for test in self.tests)
        return {
            **self.settings,
            "paper": {"legal_rate": 0.2, **paper},
            "by_seed": [
                {"seed": seed, "legal_rate": legal, **rates}
                for seed, legal, rates in zip(self.seeds, self.legal_rates, by_seed, strict=True)
            ],
            "over_seeds": {
                "legal_rate": spread(self.legal_rates),
                **rates,
            },
            "z_from_paper": {
                name: _z_score(rates[name]["mean"], cases, paper[name]["rate"], paper["cases"])
                for name in OUTCOMES
            },
        }

    def to_csv(self) -> str:
        """A header, and a line of rates for each seed."""
        header = ["seed", "cases", "legal_rate", *OUTCOMES]
        lines: list[list[Any]] = [
            [seed, len(test), legal, *(test.rate(name) for name in OUTCOMES)]
            for seed, test, legal in zip(self.seeds, self.tests, self.legal_rates, strict=True)
        ]
        return "".join(",".join(map(str, line)) + "\n" for line in (header, *lines))


def _z_score(rate: float, n: int, other: float, m: int) -> float | None:
    """Difference of the rates of n and m independent cases, over its standard error."""
    error = math.sqrt(rate * (1 - rate) / n + other * (1 - other) / m)
    return (rate - other) / error if error else None


def table1(
    *,
    seed: int = 0,
    seeds: int = 5,
    cases: int = 1_000,
    config: ConfigLike = "paper",
    variant: str = "paper",
    control: str = "pattern",
    quasi_static: bool = False,
    movements: int = 20_000,
    progress_bar: bool = False,
) -> TableOne:
    """Trains and tests an agent for each seed.

    Args:
        seed: First seed.
        seeds: Number of seeds: `seed`, `seed` + 1, ...
        cases: Tests of each seed.
        config: Body and task.
        variant: Variant of the agent, "paper" or "conjunctive".
        control: Control in the tests, a key of `CONTROLS`.
        quasi_static: Babble without the muscles' lag, which is faster.
        movements: Legal movements to learn from.
        progress_bar: Show bars with the time left.

    Raises:
        ConfigError: An unknown name, or a number out of bounds.
    """
    if control not in CONTROLS:
        raise ConfigError(f"control = {control!r} is not one of {', '.join(CONTROLS)}")
    check_seed(seed)
    check_whole("seeds", seeds, 1, 10_000, "seeds")
    env_id = CONTROLS[control]
    tests, legal_rates = [], []
    all_seeds = tuple(range(seed, seed + seeds))
    for one in all_seeds:
        env = gymnasium.make(env_id, config=config)
        agent = HebbBabbling(env, variant, seed=one, quasi_static=quasi_static)
        agent.learn(movements, progress_bar=progress_bar)
        drawn = scenarios("table1", cases, one, config=config)
        bar = progress_bar and control != "pattern"  # Pattern tests take a moment.
        tests.append(evaluate(agent, cases=drawn, progress_bar=bar))
        legal_rates.append(agent.learnt_rate)
    settings = {
        "config": str(config),
        "variant": variant,
        "control": control,
        "quasi_static": quasi_static,
        "movements": movements,
    }
    return TableOne(settings, all_seeds, tuple(tests), tuple(legal_rates))
