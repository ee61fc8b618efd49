"""The data behind the paper's Table II and Figures 7 and 8: reaching and grasping."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import gymnasium
import numpy as np

from gym_babble import _core
from gym_babble.agents import HebbGrasping
from gym_babble.config import Config, config_json
from gym_babble.envs import BabbleGraspEnv
from gym_babble.envs.choices import check_whole
from gym_babble.errors import ConfigError
from gym_babble.progress import track
from gym_babble.study.evaluation import Evaluation, evaluate, wilson
from gym_babble.study.scenarios import scenarios

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike
    from gym_babble.study.scenarios import GraspScenario

__all__ = [
    "FACTS",
    "HOLD_DIAMETERS_M",
    "PAPER_TABLE_II",
    "GraspWay",
    "TableTwo",
    "grasp_ways",
    "hold_rates",
    "recalled_hands",
    "sights",
    "table2",
]

FACTS = ("reach", "palm_reach", "held")
"""Readings of success: any part of arm or hand touches the object, the palm does, it is held."""

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
"""Table II of the paper: learned equilibrium points [deg] with the ideal ones, and rates."""

HOLD_DIAMETERS_M = (0.024, 0.03, 0.04, 0.05, 0.06)
PROTOCOLS = ("table2", "palm_side", "full")
TEST_STEPS = 240


@dataclass(frozen=True)
class Sized:
    """What came out for one diameter, over all seeds."""

    diameter: float
    hands: NDArray[np.float64]
    """Equilibrium points of thumb and finger that the tests' sights recalled (n, 2) [deg]."""
    babbled: NDArray[np.float64]
    """Those of the babbled hands (n, 2) [deg]."""
    tests: dict[str, dict[int, Evaluation]]
    """Of each protocol, the evaluation of each seed that drew cases of this size."""

    def to_json(self) -> dict[str, Any]:
        """Everything in JSON's types."""
        return {
            "diameter": self.diameter,
            "hand": {
                name: {
                    "mean": float(self.hands[:, i].mean()),
                    "spread": float(self.hands[:, i].std()),
                    "babbled_mean": _of(np.mean, self.babbled[:, i]),
                    "babbled_spread": _of(np.std, self.babbled[:, i]),
                }
                for i, name in enumerate(("thumb", "finger"))
            },
            "tests": {
                protocol: {
                    "pooled": _tally(sum(tests.values(), start=Evaluation((), (), ()))),
                    "by_seed": [{"seed": seed, **_tally(test)} for seed, test in tests.items()],
                }
                for protocol, tests in self.tests.items()
                if tests  # Of few random cases none may have this size.
            },
        }


@dataclass(frozen=True)
class TableTwo:
    """Table II over several seeds; seed s has babbling and random cases of its own."""

    settings: dict[str, Any]
    sizes: tuple[Sized, ...]
    hold: tuple[dict[str, Any], ...]
    """How well the reflex holds, of each diameter."""
    kept_rate: float
    """Share of babbles in which the hand kept the object."""

    def to_json(self) -> dict[str, Any]:
        """Rates with Wilson intervals and learned equilibrium points, beside the paper's."""
        return {
            **self.settings,
            "kept_rate": self.kept_rate,
            "paper": PAPER_TABLE_II,
            "sizes": [size.to_json() for size in self.sizes],
            "hold": list(self.hold),
        }

    def to_csv(self) -> str:
        """One line of rates for each diameter, protocol and seed, with a head."""
        lines: list[list[Any]] = [["diameter_m", "protocol", "seed", "tests", *FACTS]]
        for size in self.sizes:
            for protocol, tests in size.tests.items():
                for seed, test in tests.items():
                    rates = [float(np.mean(test.facts[name])) for name in FACTS]
                    lines.append([size.diameter, protocol, seed, len(test.outcomes), *rates])
        return "".join(",".join(map(str, line)) + "\n" for line in lines)


def _of(measure: Callable[[NDArray[np.float64]], Any], values: NDArray[np.float64]) -> float | None:
    """A measure of values; None of none, as JSON has no NaN."""
    return float(measure(values)) if len(values) else None


def _tally(result: Evaluation) -> dict[str, Any]:
    """Number of tests, and of each reading of success count, rate and 95 % Wilson interval."""
    n = len(result.outcomes)
    counted = {}
    for name in FACTS:
        count = int(np.sum(result.facts[name]))
        low, high = wilson(count, n)
        counted[name] = {"count": count, "rate": count / n, "low": low, "high": high}
    return {"tests": n, **counted}


def table2(
    *,
    seeds: int = 5,
    cases: int = 1_000,
    config: ConfigLike = "paper",
    babbles: int = 1_000,
    hold_trials: int = 100,
    progress_bar: bool = False,
) -> TableTwo:
    """Babbles, learns and is tested, once for each seed; and lets the reflex hold.

    Args:
        seeds: Seeds 0, 1, ... of babbling and of the random cases.
        cases: Random cases in each region, of each seed; half of each size on average.
        config: Body and task.
        babbles: Babbles to learn from.
        hold_trials: Trials of the reflex with each diameter; 0 for none.
        progress_bar: Show bars with the time left.

    Raises:
        ConfigError: An argument is not one there is, or the body has no list of diameters.
    """
    check_whole("seeds", seeds, 1, 10_000, "seeds")
    check_whole("cases", cases, 1, 1_000_000, "cases")
    check_whole("babbles", babbles, 1, 10_000_000, "babbles")
    diameters = _diameters(config)
    hands: dict[float, list[Any]] = {d: [] for d in diameters}
    babbled: dict[float, list[Any]] = {d: [] for d in diameters}
    tests: dict[float, dict[str, dict[int, Evaluation]]] = {
        d: {protocol: {} for protocol in PROTOCOLS} for d in diameters
    }
    kept, made = 0, 0
    for seed in range(seeds):
        agent = HebbGrasping(gymnasium.make("BabbleGrasp-v0", config=config), seed=seed)
        agent.learn(babbles, progress_bar=progress_bar)
        kept, made = kept + agent.kept, made + agent.babbles
        left = agent.babbled
        for d in diameters:
            babbled[d].append(left["hand"][left["diameter"] == d])
        for protocol in PROTOCOLS:
            drawn = scenarios(
                protocol, None if protocol == "table2" else cases, seed, config=config
            )
            for d in diameters:
                chosen = [case for case in drawn if case["diameter"] == d]
                if not chosen:
                    continue
                tests[d][protocol][seed] = _play(agent, chosen, config, progress_bar=progress_bar)
                if protocol == "table2":
                    hands[d].append(recalled_hands(agent, chosen, config))
    sizes = [
        Sized(
            diameter=d,
            hands=np.concatenate(hands[d]),
            babbled=np.concatenate(babbled[d]),
            tests=tests[d],
        )
        for d in diameters
    ]
    hold = hold_rates(hold_trials, config, progress_bar=progress_bar) if hold_trials else []
    settings = {"config": str(config), "seeds": seeds, "cases": cases, "babbles": babbles}
    return TableTwo(settings, tuple(sizes), tuple(hold), kept / made if made else float("nan"))


def _diameters(config: ConfigLike) -> list[float]:
    if Config.from_json(config_json(config)).grasp.any_diameter_between:
        raise ConfigError("grasp.any_diameter_between = true: Table II has a list of diameters")
    return sorted({case["diameter"] for case in scenarios("table2", config=config)})


def _play(
    agent: Agent, cases: Sequence[GraspScenario], config: ConfigLike, *, progress_bar: bool
) -> Evaluation:
    return evaluate(
        agent,
        "BabbleGrasp-v0",
        cases,
        config=config,
        progress_bar=progress_bar,
        max_episode_steps=TEST_STEPS,
        threads=os.cpu_count() or 1,
    )


def recalled_hands(
    agent: HebbGrasping, cases: Sequence[GraspScenario], config: ConfigLike = "paper"
) -> NDArray[np.float64]:
    """Equilibrium points of thumb and finger that the sight of each case recalls (n, 2) [deg]."""
    envs = gymnasium.make_vec("BabbleGrasp-v0", num_envs=len(cases), config=config)
    senses, _ = envs.reset(seed=0, options={"scenario": list(cases)})
    envs.close()
    return agent.decide(senses["eye"], senses["fovea"])[:, 2:]


def hold_rates(
    trials: int = 100,
    config: ConfigLike = "paper",
    diameters: Sequence[float] = HOLD_DIAMETERS_M,
    *,
    progress_bar: bool = False,
) -> list[dict[str, Any]]:
    """How many objects the reflex holds through 10 s of arm motion without support.

    The reflex closes on an object at the palm for 3 s, the support goes, and the arm moves to a
    random posture every half second.

    Raises:
        ConfigError: There are no trials, or a field of the body is not one there is.
    """
    check_whole("trials", trials, 1, 1_000_000, "trials")
    task = _core.GraspTask(config_json(config))
    rates = []
    total = trials * len(diameters)
    parts = track([trials] * len(diameters), "holding", total=total, show=progress_bar)
    for diameter, _ in zip(diameters, parts, strict=True):
        held, penetration, flexion = task.hold(diameter, trials, os.cpu_count() or 1)
        low, high = wilson(held, trials)
        rates.append(
            {
                "diameter": diameter,
                "trials": trials,
                "held": held,
                "rate": held / trials,
                "low": low,
                "high": high,
                "penetration_mm": 1000 * penetration,
                "flexion_deg": np.degrees(flexion).tolist(),
            }
        )
    return rates


class GraspWay(NamedTuple):
    """One test of Fig. 7."""

    case: GraspScenario
    palm: NDArray[np.float64]
    """Way of the palm's centre (k, 2) [m]."""
    reach: bool
    """Whether any part of arm or hand touched the object."""
    held: bool
    """Whether the hand held it."""


def grasp_ways(
    agent: Agent,
    cases: Sequence[GraspScenario],
    config: ConfigLike = "paper",
    *,
    progress_bar: bool = False,
) -> list[GraspWay]:
    """The ways of the palm in tests of an agent."""
    env = BabbleGraspEnv("rgb_array", config=config, max_episode_steps=TEST_STEPS)
    made = []
    parts = track([1] * len(cases), "testing", total=len(cases), show=progress_bar)
    for case, _ in zip(cases, parts, strict=True):
        observation, info = env.reset(seed=0, options={"scenario": case})
        state, ended = None, False
        while not ended:
            action, state = agent.predict(observation, state, None, True)  # noqa: FBT003
            observation, _, terminated, truncated, info = env.step(action)
            ended = terminated or truncated
        made.append(GraspWay(case, env.trajectory, info["reach"], info["held"]))
    return made


def sights(
    config: ConfigLike = "paper", size: int = 315
) -> list[tuple[str, list[NDArray[np.uint8]]]]:
    """What the eye sees of each diameter: name, and eye's view, fovea and edges (size, size, 3)."""
    seen = []
    for diameter in _diameters(config):
        images = []
        for camera in ("eye", "fovea", "edges"):
            env = BabbleGraspEnv("rgb_array", config=config, camera=camera, width=size, height=size)
            env.reset(seed=3, options={"diameter": diameter})
            images.append(env.render())
        seen.append((f"{100 * diameter:g} cm", images))
    return seen
