"""The paper's tests by name, with the same cases for every agent."""

from __future__ import annotations

import json
from typing import Any, Literal, TypeAlias, TypedDict, overload

from gym_babble import _core
from gym_babble.checks import check_choice, check_seed, check_threads, check_whole
from gym_babble.config import ConfigLike, config_json
from gym_babble.envs.registry import TASKS

__all__ = [
    "PROTOCOLS",
    "SPLITS",
    "GraspProtocol",
    "GraspScenario",
    "ReachProtocol",
    "Scenario",
    "scenarios",
]

PROTOCOLS = {protocol: task.name for task in TASKS.values() for protocol in task.protocols}
"""The protocols, with the task of each."""

SPLITS = ("learning", "validation", "test")
"""Disjoint sets of cases."""

MOST_CASES = 1_000_000
"""Cases of one call."""


ReachProtocol: TypeAlias = Literal["table1", "fig4"]
"""Protocols of reaching."""

GraspProtocol: TypeAlias = Literal["table2", "fig7", "palm_side", "full"]
"""Protocols of grasping."""


class Scenario(TypedDict):
    """One case of reaching. Positions are in the plane of motion [m]."""

    protocol: str
    index: int
    """Index in the protocol; in "fig4", 36 k + j is start j around target k."""
    start: tuple[float, float]
    target: tuple[float, float]
    obstacle: tuple[float, float, float] | None
    """(x, y, radius), or None without an obstacle."""


class GraspScenario(TypedDict, total=False):
    """One case of grasping."""

    protocol: str
    index: int
    """Index in the protocol; in "table2", 144 k + 12 i + j is start j and position i of the k-th
    diameter."""
    start: tuple[float, float]
    """Shoulder and elbow [rad]."""
    object: tuple[float, float]
    """Centre of the object in the plane of motion [m]."""
    diameter: float
    """Diameter of the object [m]."""
    goal: tuple[float, float]
    """Where to carry the object, with `obs="goal"` [m]."""
    obstacle: tuple[float, float, float] | None
    """(x, y, radius) [m], or None without an obstacle."""


@overload
def scenarios(
    protocol: ReachProtocol,
    n: int | None = None,
    seed: int = 0,
    *,
    split: str = "test",
    config: ConfigLike = "paper",
    threads: int | None = 1,
) -> list[Scenario]: ...


@overload
def scenarios(
    protocol: GraspProtocol,
    n: int | None = None,
    seed: int = 0,
    *,
    split: str = "test",
    config: ConfigLike = "paper",
    threads: int | None = 1,
) -> list[GraspScenario]: ...


@overload
def scenarios(
    protocol: str,
    n: int | None = None,
    seed: int = 0,
    *,
    split: str = "test",
    config: ConfigLike = "paper",
    threads: int | None = 1,
) -> list[Scenario] | list[GraspScenario]: ...


def scenarios(
    protocol: str,
    n: int | None = None,
    seed: int = 0,
    *,
    split: str = "test",
    config: ConfigLike = "paper",
    threads: int | None = 1,
) -> Any:
    """The cases of a protocol, for `reset(options={"scenario": case})`.

    Args:
        protocol: "table1": `n` legal movements (default 1,000), sampled with the full simulation,
            as the paper's tests; "fig4": 36 starts around each of 4 targets, without impossible
            ones; "table2": 12 positions of the object times 12 starts for each diameter, without
            those in which the arm starts inside the object; "fig7": the same with 12 times 11;
            "palm_side" and "full": `n` random cases of a region (default 1,000).
        n: Number of cases. A protocol with a fixed list returns its first `n`.
        seed: Seed of the random protocols.
        split: "test", or "validation" for choosing settings; they share no case, for any seed.
        config: Body and task, as for the environments.
        threads: Threads to use; all processors for None. The cases do not depend on it.

    Returns:
        The cases, as `Scenario` for reaching and `GraspScenario` for grasping.

    Raises:
        ConfigError: An unknown name, a number out of bounds, or an invalid config.
        ScenarioError: The config has no room for a case.
    """
    check_choice("protocol", protocol, PROTOCOLS)
    check_choice("split", split, SPLITS)
    seed, threads = check_seed(seed), check_threads(threads)
    many = check_whole("n", 1000 if n is None else n, 1, MOST_CASES, "cases")
    name = PROTOCOLS[protocol]
    presets = TASKS[name].protocols[protocol].presets
    task = _core.Task(name, config_json(config), json.dumps(presets))
    cases = task.cases(protocol, many, seed, split, threads)
    numbered = [
        {"protocol": protocol, "index": i, **case}
        for i, case in enumerate(cases)
        if case is not None
    ]
    return numbered if n is None else numbered[:many]
