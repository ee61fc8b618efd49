"""The paper's tests by name: the same cases for every agent."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypedDict

from gym_babble import _core
from gym_babble.config import ConfigLike, config_json
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["PROTOCOLS", "SPLITS", "GraspScenario", "Scenario", "scenarios"]

PROTOCOLS = {
    "table1": "reach",
    "fig4": "reach",
    "table2": "grasp",
    "fig7": "grasp",
    "palm_side": "grasp",
    "full": "grasp",
}
"""The protocols, and the task that each tests."""
SPLITS = ("learning", "validation", "test")


class Scenario(TypedDict):
    """One case: positions in the plane of motion [m]."""

    protocol: str
    index: int
    """Place in the protocol: in "fig4", 36 k + j is start j around target k."""
    start: tuple[float, float]
    target: tuple[float, float]
    obstacle: tuple[float, float, float] | None
    """(x, y, radius), or None."""


class GraspScenario(TypedDict, total=False):
    """One case of grasping."""

    protocol: str
    index: int
    """Place in the protocol: in "table2", 144 k + 12 i + j is start j and position i of the k-th
    diameter."""
    start: tuple[float, float]
    """Shoulder and elbow [rad]."""
    object: tuple[float, float]
    """Centre of the object in the plane of motion [m]."""
    diameter: float
    """Diameter of the object [m]."""
    goal: tuple[float, float]
    """With `obs="goal"`: where the object is to be carried [m]."""
    obstacle: tuple[float, float, float] | None
    """(x, y, radius) [m], or None."""


def scenarios(
    protocol: str,
    n: int | None = None,
    seed: int = 0,
    *,
    split: str = "test",
    config: ConfigLike = "paper",
    threads: int = 1,
) -> list[Any]:
    """The cases of a protocol, for `reset(options={"scenario": case})`.

    Args:
        protocol: "table1": `n` legal movements (1,000 if not given), drawn by the full simulation
            as the paper drew its tests; "fig4": 36 starts around each of 4 targets, where there
            is a case; "table2": 12 positions of the object times 12 starts for each diameter, where
            the arm does not begin in the object; "fig7": 12 times 11; "palm_side" and "full": `n`
            random cases of a region (1,000 if not given).
        n: How many; the first ones of a protocol that has a fixed list.
        seed: Seed of the draw.
        split: "test", or "validation" for choosing settings: disjoint for every seed.
        config: Body and task, as for the environments.
        threads: Threads that draw; the cases do not depend on them.

    Returns:
        `Scenario`s of reaching or `GraspScenario`s.

    Raises:
        ConfigError: A name, number or config is not one there is.
        ScenarioError: The config leaves no room for a case.
    """
    if protocol not in PROTOCOLS:
        raise ConfigError(f"protocol = {protocol!r} is not one of {', '.join(PROTOCOLS)}")
    if n is not None and n < 1:
        raise ConfigError(f"n = {n} is not at least 1")
    check_seed(seed)
    if split not in SPLITS:
        raise ConfigError(f"split = {split!r} is not one of {', '.join(SPLITS)}")
    many = 1000 if n is None else n
    cases: Iterable[Any]
    if PROTOCOLS[protocol] == "grasp":
        region = protocol if protocol == "palm_side" else "full"
        task = _core.GraspTask(config_json(config), region=region)
        cases = task.cases(protocol, many, seed, split, threads)
    elif protocol == "table1":
        cases = _core.ReachTask(config_json(config)).table1(many, seed, split, threads)
    else:
        cases = _core.ReachTask(config_json(config)).fig4()
    numbered = [
        {"protocol": protocol, "index": i, **case}
        for i, case in enumerate(cases)
        if case is not None
    ]
    return numbered[:n]


def check_seed(seed: int) -> None:
    """Raises `ConfigError` unless the core can take the seed."""
    if not 0 <= seed < 2**64:
        raise ConfigError(f"seed = {seed} is not in [0, 2^64)")
