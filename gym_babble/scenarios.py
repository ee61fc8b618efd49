"""The paper's tests by name: the same cases for every agent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypedDict

import numpy as np

from gym_babble import _core
from gym_babble.config import BodyLike, config_json
from gym_babble.errors import ConfigError, ScenarioError

if TYPE_CHECKING:
    from gym_babble._core import Task

__all__ = ["PROTOCOLS", "SPLITS", "Request", "Scenario", "read_options", "scenarios"]

PROTOCOLS = ("table1", "fig4")
SPLITS = ("learning", "validation", "test")
CASE_OPTIONS = ("start", "target", "obstacle")


class Scenario(TypedDict):
    """One case: positions in the plane of motion [m]."""

    protocol: str
    index: int
    """Place in the protocol: in "fig4", 36 k + j is start j around target k."""
    start: tuple[float, float]
    target: tuple[float, float]
    obstacle: tuple[float, float, float] | None
    """(x, y, radius), or None."""


def scenarios(
    protocol: str,
    n: int | None = None,
    seed: int = 0,
    *,
    split: str = "test",
    body: BodyLike = "paper",
    threads: int = 1,
) -> list[Scenario]:
    """The cases of a protocol, for `reset(options={"scenario": case})`.

    Args:
        protocol: "table1": `n` legal movements (1,000 if not given), drawn by the full simulation
            as the paper drew its tests; "fig4": 36 starts around each of 4 targets, where there
            is a case.
        n: How many; the first ones of a protocol that has a fixed list.
        seed: Seed of the draw.
        split: "test", or "validation" for choosing settings: disjoint for every seed.
        body: Body and task, as for the environments.
        threads: Threads that draw; the cases do not depend on them.

    Raises:
        ConfigError: A name, number or config is not one there is.
        ScenarioError: The config leaves no room for a case.
    """
    if protocol not in PROTOCOLS:
        raise ConfigError(f"protocol = {protocol!r} is not one of {', '.join(PROTOCOLS)}")
    if n is not None and n < 1:
        raise ConfigError(f"n = {n} is not at least 1")
    check_seed(seed)
    task = _core.Task(config_json(body))
    if protocol == "table1":
        cases = dict(enumerate(task.table1(1000 if n is None else n, seed, split, threads)))
    else:
        cases = {i: case for i, case in enumerate(task.fig4()) if case is not None}
    numbered = [
        Scenario(
            protocol=protocol,
            index=i,
            start=case["start"],
            target=case["target"],
            obstacle=case["obstacle"],
        )
        for i, case in cases.items()
    ]
    return numbered[:n]


def check_seed(seed: int) -> None:
    """Raises `ConfigError` unless the core can take the seed."""
    if not 0 <= seed < 2**64:
        raise ConfigError(f"seed = {seed} is not in [0, 2^64)")


class Request(NamedTuple):
    """What reset options ask of the cases to come; what is None is drawn."""

    start: list[float] | None
    target: list[float] | None
    obstacle: list[float] | None
    no_obstacle: bool


def read_options(options: Any, task: Task) -> Request:
    """What `reset(options=...)` asks for.

    Raises:
        ConfigError: An option is unknown.
        ScenarioError: A position is not made of two numbers.
    """
    if not isinstance(options, Mapping):
        raise ConfigError(f"options is a {type(options).__name__}, expected a dict")
    scenario = options.get("scenario")
    if scenario is not None:
        if not isinstance(scenario, Mapping):
            raise ScenarioError(f"scenario is a {type(scenario).__name__}, expected a Scenario")
        options = {**scenario, **{k: v for k, v in options.items() if k != "scenario"}}
    unknown = set(options) - {*CASE_OPTIONS, "scenario", "protocol", "index"}
    if unknown:
        known = ", ".join(("scenario", *CASE_OPTIONS))
        raise ConfigError(f"options: {sorted(map(str, unknown))} unknown; there are {known}")
    return Request(
        start=_numbers("start", options.get("start"), 2),
        target=_numbers("target", options.get("target"), 2),
        obstacle=_obstacle(task, options.get("obstacle")),
        no_obstacle="obstacle" in options and options["obstacle"] is None,
    )


def _obstacle(task: Task, value: Any) -> list[float] | None:
    """An obstacle (x, y, radius); of two numbers the radius is the config's."""
    if isinstance(value, Sequence | np.ndarray) and len(value) == 2:
        value = (*value, task.obstacle_radius)
    return _numbers("obstacle", value, 3)


def _numbers(name: str, value: Any, n: int) -> list[float] | None:
    if value is None:
        return None
    try:
        numbers = [float(x) for x in value]
    except (TypeError, ValueError) as error:
        raise ScenarioError(f"{name} = {value!r} is not made of {n} numbers [m]") from error
    if len(numbers) != n:
        raise ScenarioError(f"{name} = {value!r} has {len(numbers)} numbers, expected {n} [m]")
    return numbers
