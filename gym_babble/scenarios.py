"""The paper's tests by name: the same cases for every agent."""

from __future__ import annotations

from typing import TypedDict

from gym_babble import _core
from gym_babble.config import BodyLike, config_json
from gym_babble.errors import ConfigError

__all__ = ["PROTOCOLS", "SPLITS", "Scenario", "scenarios"]

PROTOCOLS = ("table1", "fig4")
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
    task = _core.ReachTask(config_json(body))
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
