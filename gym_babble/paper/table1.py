"""Table I: success, collision and joint-limit rates of reaching."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np

from gym_babble.agents import HebbBabbling
from gym_babble.errors import ConfigError
from gym_babble.study.evaluation import Evaluation, evaluate
from gym_babble.study.rates import OUTCOMES, paper_tally, t_interval, tally
from gym_babble.study.scenarios import scenarios

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.config import ConfigLike

__all__ = ["CONTROLS", "TableOne", "table1"]

CONTROLS = {"pattern": "BabbleReachPattern-v0", "delta_posture": "BabbleReach-v0"}
"""Controls for the tests of Table I, with their environments."""


@dataclass(frozen=True)
class TableOne:
    """Table I over several seeds; each seed has its own babbling and tests."""

    settings: dict[str, Any]
    """The arguments of `table1`."""
    tests: tuple[Evaluation, ...]
    """The tests of each seed."""
    legal_rates: tuple[float, ...]
    """Share of the babbled movements that were legal, for each seed."""

    def to_json(self) -> dict[str, Any]:
        """Rates by seed and pooled, with Wilson intervals; means over seeds, with t intervals."""
        by_seed = [tally(test) for test in self.tests]
        pooled = tally(sum(self.tests, start=Evaluation((), (), ())))
        return {
            **self.settings,
            "paper": {"legal_rate": 0.2, **paper_tally()},
            "by_seed": [
                {"seed": seed, "legal_rate": legal, **rates}
                for seed, (legal, rates) in enumerate(zip(self.legal_rates, by_seed, strict=True))
            ],
            "pooled": {"legal_rate": float(np.mean(self.legal_rates)), **pooled},
            "over_seeds": {
                "legal_rate": _spread(self.legal_rates),
                **{name: _spread([rates[name]["rate"] for rates in by_seed]) for name in OUTCOMES},
            },
        }

    def to_csv(self) -> str:
        """A header, and a line of rates for each seed."""
        header = ["seed", "cases", "legal_rate", *OUTCOMES]
        lines: list[list[Any]] = [
            [seed, len(test.outcomes), legal, *(test.rate(name) for name in OUTCOMES)]
            for seed, (test, legal) in enumerate(zip(self.tests, self.legal_rates, strict=True))
        ]
        return "".join(",".join(map(str, line)) + "\n" for line in (header, *lines))


def _spread(values: Sequence[float]) -> dict[str, float | None]:
    interval = t_interval(values)
    low, high = (None, None) if interval is None else np.clip(interval, 0.0, 1.0).tolist()
    return {"mean": float(np.mean(values)), "low": low, "high": high}


def table1(
    *,
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
        seeds: Number of seeds: 0, 1, ...
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
    env_id = CONTROLS[control]
    tests, legal_rates = [], []
    for seed in range(seeds):
        env = gymnasium.make(env_id, config=config)
        agent = HebbBabbling(env, variant, seed=seed, quasi_static=quasi_static)
        agent.learn(movements, progress_bar=progress_bar)
        drawn = scenarios("table1", cases, seed, config=config)
        bar = progress_bar and control != "pattern"  # Pattern tests take a moment.
        tests.append(evaluate(agent, env_id, drawn, config=config, progress_bar=bar))
        legal_rates.append(agent.learnt_rate)
    settings = {
        "config": str(config),
        "variant": variant,
        "control": control,
        "quasi_static": quasi_static,
        "movements": movements,
    }
    return TableOne(settings, tuple(tests), tuple(legal_rates))
