"""The data behind the paper's Table I and Figures 4 and 5."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import gymnasium
import numpy as np

from gym_babble import _core
from gym_babble.agents import HebbBabbling
from gym_babble.config import config_json
from gym_babble.envs import BabbleReachEnv
from gym_babble.errors import ConfigError, ScenarioError
from gym_babble.study.evaluation import Evaluation, evaluate
from gym_babble.study.scenarios import Scenario, scenarios
from gym_babble.study.tables import OUTCOMES, paper_tally, t_interval, tally

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike

__all__ = [
    "CONTROLS",
    "TableOne",
    "Way",
    "WeightSets",
    "starts_without_case",
    "switched",
    "table1",
    "ways",
    "weight_sets",
]

CONTROLS = {"pattern": "BabbleReachPattern-v0", "delta_posture": "BabbleReach-v0"}
"""Controls that Table I can be tested in, with their environments."""

STARTS = 36


@dataclass(frozen=True)
class TableOne:
    """Table I over several seeds; seed s has babbling and tests of its own."""

    settings: dict[str, Any]
    tests: tuple[Evaluation, ...]
    legal_rates: tuple[float, ...]

    def to_json(self) -> dict[str, Any]:
        """Rates by seed and pooled with Wilson intervals, means with t intervals over seeds."""
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
        """One line of rates for each seed, with a head."""
        head = ["seed", "cases", "legal_rate", *OUTCOMES]
        lines: list[list[Any]] = [
            [seed, len(test.outcomes), legal, *(test.rate(name) for name in OUTCOMES)]
            for seed, (test, legal) in enumerate(zip(self.tests, self.legal_rates, strict=True))
        ]
        return "".join(",".join(map(str, line)) + "\n" for line in (head, *lines))


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
    """Babbles, learns and is tested, once for each seed.

    Raises:
        ConfigError: An argument is not one there is.
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
        bar = progress_bar and control != "pattern"  # There it takes but a moment.
        tests.append(evaluate(agent, env_id, drawn, config=config, progress_bar=bar))
        legal_rates.append(agent.legal_rate)
    settings = {
        "config": str(config),
        "variant": variant,
        "control": control,
        "quasi_static": quasi_static,
        "movements": movements,
    }
    return TableOne(settings, tuple(tests), tuple(legal_rates))


class Way(NamedTuple):
    """One movement of Fig. 4."""

    case: Scenario
    fingertip: NDArray[np.float64]
    """Its way (k, 2) [m]."""
    b1: float
    """Above ½ the path curves to the left."""
    outcome: str


def ways(agent: Agent, cases: Sequence[Scenario], config: ConfigLike = "paper") -> list[Way]:
    """The movements an agent chooses, in `pattern` control; cases that cannot be are left out."""
    env = BabbleReachEnv("rgb_array", control="pattern", reward="sparse", config=config)
    made = []
    for case in cases:
        try:
            observation, _ = env.reset(options={"scenario": case})
        except ScenarioError:
            continue
        action, _ = agent.predict(observation, deterministic=True)
        *_, info = env.step(action)
        b1 = 0.5 + 0.5 * float(action[0])
        made.append(Way(case, env.trajectory, b1, info["outcome"]))
    return made


def switched(case: Scenario) -> Scenario:
    """The case with obstacle and start in each other's place, as at the right of Fig. 4."""
    if case["obstacle"] is None:
        raise ScenarioError("there is no obstacle to switch with the start")
    x, y, radius = case["obstacle"]
    return {**case, "start": (x, y), "obstacle": (*case["start"], radius)}


def starts_without_case(config: ConfigLike = "paper") -> NDArray[np.float64]:
    """Starts of Fig. 4 (n, 2) [m] out of reach, or with the arm inside of the obstacle."""
    listed = _core.ReachTask(config_json(config)).fig4()
    angles = 2.0 * np.pi * np.arange(STARTS) / STARTS
    missing = []
    for first in range(0, len(listed), STARTS):
        around = listed[first : first + STARTS]
        known = next((case for case in around if case is not None), None)
        if known is None:
            continue
        target = np.array(known["target"])
        radius = np.linalg.norm(np.array(known["start"]) - target)
        starts = target + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        missing += [start for start, case in zip(starts, around, strict=True) if case is None]
    return np.array(missing).reshape(-1, 2)


@dataclass(frozen=True)
class WeightSets:
    """The two sets of input neurons of Fig. 5."""

    patterns: NDArray[np.float32]
    """Weights to the output map, of each input neuron: (rows, columns, b2, b1)."""
    left: NDArray[np.bool_]
    """Input neurons (rows, columns) whose weights alone make a movement that curves left."""
    right: NDArray[np.bool_]
    """The same for right."""

    def mean(self, members: NDArray[np.bool_]) -> NDArray[np.float32]:
        """Mean weights (b2, b1) of a set."""
        mean: NDArray[np.float32] = self.patterns[members].mean(axis=0)
        return mean

    def typical(self, members: NDArray[np.bool_]) -> tuple[int, int]:
        """The input neuron (row, column) of a set whose weights are most like the set's mean."""
        mean = self.mean(members).ravel()
        places = np.argwhere(members)
        likeness = [np.corrcoef(self.patterns[r, c].ravel(), mean)[0, 1] for r, c in places]
        row, column = places[int(np.argmax(likeness))].tolist()
        return row, column

    @property
    def mirror_correlation(self) -> float:
        """Correlation of the left set's mean with the right set's, b1 and b2 exchanged."""
        left, right = self.mean(self.left), self.mean(self.right)
        return float(np.corrcoef(left.ravel(), right.T.ravel())[0, 1])


def weight_sets(agent: HebbBabbling) -> WeightSets:
    """Divides the input neurons by the way their weights alone would make a movement curve.

    Neurons whose weights all stay below half of w_max have seen too few obstacles to count.

    Raises:
        ConfigError: The input map is not a map of the obstacle alone, or nothing was learnt.
    """
    if len(agent.input_shape) != 2:
        raise ConfigError("Fig. 5 shows the paper's input map; use variant 'paper'")
    weights = agent.weights["weights"]
    side = round(len(weights) ** 0.5)
    patterns = weights.T.reshape(*agent.input_shape, side, side)
    activity = np.maximum(np.tanh(patterns), 0.0)  # Eq. 4 for one active input neuron.
    b1 = (activity * np.linspace(0.0, 1.0, side)).sum((2, 3))
    b1 = b1 / np.maximum(activity.sum((2, 3)), 1e-9)
    taught = np.abs(patterns).max((2, 3)) > 0.5 * agent.config["rule"]["w_max"]
    left, right = taught & (b1 > 0.5), taught & (b1 <= 0.5)
    if not (left.any() and right.any()):
        raise ConfigError("the agent has not learnt both curves yet; babble more movements")
    return WeightSets(patterns, left, right)
