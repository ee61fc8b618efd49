"""Table II: learned postures of the hand, and how reaching and grasping end."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np

from gym_babble.agents import HebbBabbling
from gym_babble.agents.acting import EnvArguments
from gym_babble.checks import check_seed, check_whole, processors
from gym_babble.config import Config, config_json
from gym_babble.errors import ConfigError
from gym_babble.paper.holding import hold_rates
from gym_babble.study.evaluation import evaluate, for_cases
from gym_babble.study.rates import counted, counts, over_seeds
from gym_babble.study.scenarios import scenarios

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from gym_babble.agents import Experiences
    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike
    from gym_babble.study.outcomes import Evaluation
    from gym_babble.study.scenarios import GraspProtocol, GraspScenario

__all__ = [
    "FACTS",
    "PAPER_TABLE_II",
    "SizeResult",
    "TableTwo",
    "recalled_hands",
    "table2",
    "table_diameters",
]

FACTS = ("reach", "palm_reach", "held")
"""Facts at the end of a test: arm or hand touched the object, the palm did, the hand held it."""

PAPER_TABLE_II: dict[str, dict[str, Any]] = {
    "small": {
        "thumb": {"mean": 36.99, "ideal": 20.0, "spread": 0.027},
        "finger": {"mean": 17.30, "ideal": 20.0, "spread": 0.012},
        "tests": 144,
        "reach": 0.715,
        "held": 0.028,
    },
    "big": {
        "thumb": {"mean": 12.31, "ideal": 50.0, "spread": 0.017},
        "finger": {"mean": 46.34, "ideal": 50.0, "spread": 0.050},
        "tests": 144,
        "reach": 0.931,
        "held": 0.111,
    },
}
"""Table II of the paper: learned and ideal equilibrium points [deg], and rates."""

PROTOCOLS: tuple[GraspProtocol, ...] = ("table2", "palm_side", "full")

TEST_STEPS = 240
"""Time limit of a test [control steps]."""


@dataclass(frozen=True)
class SizeResult:
    """Results for one diameter, over all seeds."""

    diameter: float
    """Diameter [m]."""
    hands: NDArray[np.float64]
    """Equilibrium points of thumb and finger recalled in the tests (n, 2) [deg]."""
    babbled: NDArray[np.float64]
    """Equilibrium points of the babbled hands (n, 2) [deg]."""
    tests: dict[str, dict[int, Evaluation]]
    """Evaluations by protocol and seed; seeds without cases of this size are missing."""

    def to_json(self) -> dict[str, Any]:
        """The results as JSON types."""
        return {
            "diameter": self.diameter,
            "hand": {
                name: {
                    "mean": float(self.hands[:, i].mean()),
                    "spread": float(self.hands[:, i].std()),
                    "babbled_mean": _statistic(np.mean, self.babbled[:, i]),
                    "babbled_spread": _statistic(np.std, self.babbled[:, i]),
                }
                for i, name in enumerate(("thumb", "finger"))
            },
            "tests": {
                protocol: {
                    "over_seeds": over_seeds([_tally(test) for test in tests.values()], FACTS),
                    "by_seed": [{"seed": seed, **_tally(test)} for seed, test in tests.items()],
                }
                for protocol, tests in self.tests.items()
                if tests  # A few random cases may include none of this size.
            },
        }


@dataclass(frozen=True)
class TableTwo:
    """Table II over several seeds; each seed has its own babbling and random cases."""

    settings: dict[str, Any]
    """The arguments of `table2`."""
    sizes: tuple[SizeResult, ...]
    """Results for each diameter."""
    hold: tuple[dict[str, Any], ...]
    """How many objects the reflex holds, from `hold_rates`."""
    kept_rate: float
    """Share of babbles in which the hand kept the object."""

    def to_json(self) -> dict[str, Any]:
        """Rates and learned equilibrium points, with the paper's."""
        return {
            **self.settings,
            "kept_rate": self.kept_rate,
            "paper": PAPER_TABLE_II,
            "sizes": [size.to_json() for size in self.sizes],
            "hold": list(self.hold),
        }

    def to_csv(self) -> str:
        """A header, and a line of rates for each diameter, protocol and seed."""
        lines: list[list[Any]] = [["diameter_m", "protocol", "seed", "cases", *FACTS]]
        for size in self.sizes:
            for protocol, tests in size.tests.items():
                for seed, test in tests.items():
                    rates = [test.rate(name) for name in FACTS]
                    lines.append([size.diameter, protocol, seed, len(test), *rates])
        return "".join(",".join(map(str, line)) + "\n" for line in lines)


def _statistic(
    measure: Callable[[NDArray[np.float64]], Any], values: NDArray[np.float64]
) -> float | None:
    """A statistic of the values; None without values, because JSON has no NaN."""
    return float(measure(values)) if len(values) else None


def _tally(test: Evaluation) -> dict[str, Any]:
    """Number of cases; for each fact its count, rate and 95 % Wilson interval."""
    return counted(counts(test, FACTS))


def table2(
    *,
    seed: int = 0,
    seeds: int = 5,
    cases: int = 1_000,
    config: ConfigLike = "paper",
    variant: str = "paper",
    babbles: int = 1_000,
    hold_trials: int = 100,
    progress_bar: bool = False,
) -> TableTwo:
    """Trains and tests an agent for each seed, and tests the reflex.

    Args:
        seed: First seed of babbling and of the random cases.
        seeds: Number of seeds: `seed`, `seed` + 1, ...
        cases: Random cases in each region, for each seed; half of each size on average.
        config: Body and task.
        variant: Variant of the agent, "paper" or "chain".
        babbles: Babbles to learn from.
        hold_trials: Trials of the reflex for each diameter; 0 skips them.
        progress_bar: Show bars with the time left.

    Raises:
        ConfigError: A number out of bounds, or a config without a list of diameters.
    """
    check_seed(seed)
    check_whole("seeds", seeds, 1, 10_000, "seeds")
    check_whole("cases", cases, 1, 1_000_000, "cases")
    check_whole("babbles", babbles, 1, 10_000_000, "babbles")
    sizes = {d: _Collected() for d in table_diameters(config)}
    kept, made = 0, 0
    for one in range(seed, seed + seeds):
        agent = HebbBabbling(gymnasium.make("BabbleGrasp-v0", config=config), variant, seed=one)
        agent.learn(babbles, progress_bar=progress_bar)
        kept, made = kept + agent.learnt, made + agent.babbled
        experiences = agent.experiences()
        for diameter, collected in sizes.items():
            collected.add_babbles(experiences, diameter)
        for protocol in PROTOCOLS:
            drawn = (
                scenarios(protocol, config=config)
                if protocol == "table2"
                else scenarios(protocol, cases, one, config=config)
            )
            for diameter, collected in sizes.items():
                chosen = [case for case in drawn if case["diameter"] == diameter]
                if chosen:
                    test = _play(agent, chosen, progress_bar=progress_bar)
                    collected.tests[protocol][one] = test
                if protocol == "table2":
                    collected.hands.append(recalled_hands(agent, chosen))
    hold = hold_rates(hold_trials, config, progress_bar=progress_bar) if hold_trials else []
    settings = {
        "config": str(config),
        "variant": variant,
        "seed": seed,
        "seeds": seeds,
        "cases": cases,
        "babbles": babbles,
    }
    return TableTwo(
        settings,
        tuple(collected.result(diameter) for diameter, collected in sizes.items()),
        tuple(hold),
        kept / made,
    )


@dataclass
class _Collected:
    """The results of some seeds for one diameter."""

    hands: list[NDArray[np.float64]] = field(default_factory=list)
    babbled: list[NDArray[np.float64]] = field(default_factory=list)
    tests: dict[str, dict[int, Evaluation]] = field(
        default_factory=lambda: {protocol: {} for protocol in PROTOCOLS}
    )

    def add_babbles(self, kept: Experiences, diameter: float) -> None:
        of_size = kept.case["diameter"][:, 0] == np.float32(diameter)
        self.babbled.append(kept.actions["hand"][of_size])

    def result(self, diameter: float) -> SizeResult:
        return SizeResult(
            diameter=diameter,
            hands=np.concatenate(self.hands),
            babbled=np.concatenate(self.babbled),
            tests=self.tests,
        )


def table_diameters(config: ConfigLike) -> list[float]:
    """The diameters of Table II's tests [m].

    Raises:
        ConfigError: The config has a range of diameters instead of a list.
    """
    if Config.from_json(config_json(config)).grasp.any_diameter_between:
        raise ConfigError("grasp.any_diameter_between = true: Table II needs a list of diameters")
    return sorted({case["diameter"] for case in scenarios("table2", config=config)})


def _play(agent: Agent, cases: Sequence[GraspScenario], *, progress_bar: bool) -> Evaluation:
    return evaluate(
        agent,
        cases=cases,
        progress_bar=progress_bar,
        max_episode_steps=TEST_STEPS,
        threads=processors(),
    )


def recalled_hands(agent: HebbBabbling, cases: Sequence[GraspScenario]) -> NDArray[np.float64]:
    """Equilibrium points of thumb and finger that each case recalls (n, 2) [deg]."""
    envs = for_cases(EnvArguments.of(agent.interface), cases, {}).batch(len(cases))
    senses, _ = envs.reset(seed=0, options={"scenario": list(cases)})
    envs.close()
    return agent.decide(senses)[:, -2:]
