"""Whole movements in reaching, as judges play them again."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np

from gym_babble.study.scenarios import scenarios

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["held_out", "outcomes", "success_rate"]


@cache
def held_out(n: int) -> tuple[Any, ...]:
    """Legal cases of Table I that no test and no babble has."""
    return tuple(scenarios("table1", n=n, seed=1, split="validation"))


@cache
def _environments(n: int) -> Any:
    return gymnasium.make_vec("BabbleReachPattern-v0", num_envs=n)


def outcomes(cases: tuple[Any, ...], b: ArrayLike) -> NDArray[np.str_]:
    """How a movement ends in each case: "success", "collision" or "joint_limit".

    Args:
        cases: The cases.
        b: Parameters (b1, b2) of each movement (n, 2), or of all (2,). As in the environment, they
            are cut to [.01, .99].
    """
    envs = _environments(len(cases))
    envs.reset(options={"scenario": list(cases)})
    actions = 2.0 * np.broadcast_to(np.asarray(b), (len(cases), 2)) - 1.0
    _, _, _, _, infos = envs.step(np.clip(actions, -1.0, 1.0).astype(np.float32))
    found = np.full(len(cases), "running", dtype="U11")
    for name in ("success", "collision", "joint_limit"):
        found[infos["outcome"][name]] = name
    return found


def success_rate(cases: tuple[Any, ...], b: ArrayLike) -> float:
    """Share of the cases in which a movement (b1, b2), or one for each case, succeeds."""
    return float(np.mean(outcomes(cases, b) == "success"))
