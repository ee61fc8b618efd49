"""The paper's tests by name, with the same cases for every agent."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict, overload

from gym_babble import _core
from gym_babble.checks import (
    check_choice,
    check_flag,
    check_seed,
    check_threads,
    check_whole,
    plain,
    shown,
)
from gym_babble.config import ConfigLike, config_json
from gym_babble.envs.labels import config_label
from gym_babble.envs.registry import TASKS
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.envs.registry import Protocol

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
    config: str
    """Name of the config: its profile, with a hash if it differs from that."""


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
    """Where to carry the object [m], in cases of the goal form."""
    obstacle: tuple[float, float, float] | None
    """(x, y, radius) [m], or None without an obstacle."""
    config: str
    """Name of the config: its profile, with a hash if it differs from that."""


@overload
def scenarios(
    protocol: ReachProtocol,
    n: int | None = None,
    seed: int | None = None,
    *,
    split: str | None = None,
    goal: bool = False,
    diameters: Sequence[float] | None = None,
    config: ConfigLike = "paper",
    threads: int | None = 1,
) -> list[Scenario]: ...


@overload
def scenarios(
    protocol: GraspProtocol,
    n: int | None = None,
    seed: int | None = None,
    *,
    split: str | None = None,
    goal: bool = False,
    diameters: Sequence[float] | None = None,
    config: ConfigLike = "paper",
    threads: int | None = 1,
) -> list[GraspScenario]: ...


@overload
def scenarios(
    protocol: str,
    n: int | None = None,
    seed: int | None = None,
    *,
    split: str | None = None,
    goal: bool = False,
    diameters: Sequence[float] | None = None,
    config: ConfigLike = "paper",
    threads: int | None = 1,
) -> list[Scenario] | list[GraspScenario]: ...


def scenarios(
    protocol: str,
    n: int | None = None,
    seed: int | None = None,
    *,
    split: str | None = None,
    goal: bool = False,
    diameters: Sequence[float] | None = None,
    config: ConfigLike = "paper",
    threads: int | None = 1,
) -> Any:
    """The cases of a protocol, for `reset(options={"scenario": case})`.

    Args:
        protocol: "table1": `n` legal movements (default 1,000), sampled with the full simulation,
            as the paper's tests; "fig4": 36 starts around each of 4 targets; "table2": 12 positions
            of the object times 12 starts for each diameter, without those in which the arm starts
            inside the object; "fig7": the same with 12 times 11; "palm_side" and "full": `n` random
            cases of a region (default 1,000).
        n: Number of cases of a random protocol.
        seed: Seed of a random protocol; 0 if not given.
        split: Of a random protocol "test" (if not given), or "validation" for choosing settings;
            they share no case, for any seed.
        goal: In grasping, for the goal form: each case has a goal, where to carry the object.
        diameters: In grasping, diameters of the objects [m]; those of the config if not given. Of a
            random protocol each case has one of them, of a fixed list each position has all.
        config: Body and task, as for the environments.
        threads: Threads to use; all processors for None. The cases do not depend on it.

    Returns:
        The cases, as `Scenario` for reaching and `GraspScenario` for grasping.

    Raises:
        ConfigError: An unknown name, a number out of bounds, an invalid config, or an argument that
            the protocol does not have: a fixed list has no `n`, seed or split, and in reaching the
            target is the goal.
        ScenarioError: The config has no room for a case.
    """
    entry = TASKS[PROTOCOLS[check_choice("protocol", protocol, PROTOCOLS)]]
    _check(entry.protocols[protocol], n, seed, split)
    options = dict(entry.protocols[protocol].presets)
    if check_flag("goal", goal):
        if "goal" not in {part.name for part in entry.case_parts}:
            raise ConfigError(f"goal = True: cases of {entry.title} have no goal of their own")
        options |= {"obs": "goal", "reward": "sparse"}
    if diameters is not None:
        if "diameters" not in entry.defaults:
            raise ConfigError(f"diameters = {shown(diameters)}: {entry.title} has no objects")
        options["diameters"] = plain(diameters, "diameters")
    task = _core.Task(entry.name, config_json(config), json.dumps(options))
    many, stream, purpose = int(n or 1_000), int(seed or 0), split or "test"
    cases = task.cases(protocol, many, stream, purpose, check_threads(threads))
    label = config_label(task, entry.name)
    return [
        {"protocol": protocol, "index": i, **case, "config": label}
        for i, case in enumerate(cases)
        if case is not None
    ]


def _check(protocol: Protocol, n: int | None, seed: int | None, split: str | None) -> None:
    if n is not None:
        check_whole("n", n, 1, MOST_CASES, "cases")
    if seed is not None:
        check_seed(seed)
    if split is not None:
        check_choice("split", split, SPLITS)
    if protocol.random:
        return
    for name, value in (("n", n), ("seed", seed), ("split", split)):
        if value is not None:
            raise ConfigError(
                f"{name} = {shown(value)}: {protocol.name!r} is one fixed list of cases, the same "
                f"for every seed and split; it takes no {name}"
            )
