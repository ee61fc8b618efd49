"""Equality to the bit, for observations, infos and whatever else is nested."""

from __future__ import annotations

from typing import Any

import numpy as np

from gym_babble.envs import (
    BabbleGraspEnv,
    BabbleGraspVectorEnv,
    BabbleReachEnv,
    BabbleReachVectorEnv,
    registry,
)

IDS = ("BabbleReach-v0", "BabbleReachSparse-v0", "BabbleReachGoal-v0", "BabbleReachPattern-v0")
GRASP_IDS = (
    "BabbleGrasp-v0",
    "BabbleGraspSparse-v0",
    "BabbleGraspGoal-v0",
    "BabbleGraspFull-v0",
)
ALL_IDS = (*IDS, *GRASP_IDS)
CONTROLS = ("delta_posture", "posture", "torque", "pattern")
OBSERVATIONS = ("senses", "flat", "goal", "retina")
REGIONS = ("palm_side", "full")
WHERE = dict(zip(REGIONS, (GRASP_IDS[0], GRASP_IDS[3]), strict=True))
"""The id of each region."""

TASKS = {"reach": BabbleReachEnv, "grasp": BabbleGraspEnv}
ENVIRONMENTS = [row for row in registry.ENVIRONMENTS if row.task in TASKS]
"""The ids of these tasks, without that of the toy task."""
BATCHES = {"reach": BabbleReachVectorEnv, "grasp": BabbleGraspVectorEnv}
CONTROLS_OF = {"reach": CONTROLS, "grasp": CONTROLS[:3]}
EACH_CONTROL = [(task, control) for task, controls in CONTROLS_OF.items() for control in controls]


def rewards_for(obs: str) -> tuple[str, ...]:
    return ("sparse",) if obs == "goal" else ("progress", "sparse")


CHOICES = [
    {"obs": obs, "control": control, "reward": reward}
    for obs in OBSERVATIONS
    for control in CONTROLS
    for reward in rewards_for(obs)
]
GRASP_CHOICES = [
    {**choices, "region": region}
    for choices in CHOICES
    if choices["control"] in CONTROLS_OF["grasp"]
    for region in REGIONS
]
ALL_CHOICES = [
    *((IDS[0], choices) for choices in CHOICES),
    *((WHERE[choices["region"]], choices) for choices in GRASP_CHOICES),
]
"""Every combination of named choices, with an id that takes it."""


def assert_same(one: Any, other: Any, where: str = "") -> None:
    """Same structure, types and bits."""
    if isinstance(one, dict):
        assert isinstance(other, dict), where
        assert one.keys() == other.keys(), (where, one.keys() ^ other.keys())
        for key in one:
            assert_same(one[key], other[key], f"{where}.{key}")
    elif isinstance(one, tuple | list):
        assert len(one) == len(other), where
        for i, (a, b) in enumerate(zip(one, other, strict=True)):
            assert_same(a, b, f"{where}[{i}]")
    elif isinstance(one, np.ndarray) and one.dtype == object:
        assert other.dtype == object, where
        assert_same(list(one), list(other), where)
    elif isinstance(one, np.ndarray):
        assert isinstance(other, np.ndarray), where
        assert (one.dtype, one.shape) == (other.dtype, other.shape), where
        assert one.tobytes() == other.tobytes(), (where, one, other)
    else:
        assert type(one) is type(other), (where, type(one), type(other))
        assert one == other, where


def one_of(batch: Any, i: int) -> Any:
    """Row i of a batch of observations."""
    if isinstance(batch, dict):
        return {name: one_of(value, i) for name, value in batch.items()}
    return np.array(batch[i])


def info_of(infos: dict[str, Any], i: int) -> dict[str, Any]:
    """The info of environment i in the layout of a vector environment."""
    found = {}
    for name, values in infos.items():
        if name.startswith("_") or not infos[f"_{name}"][i]:
            continue
        if isinstance(values, dict):
            found[name] = info_of(values, i)
        else:
            value = values[i]
            found[name] = value.item() if isinstance(value, np.generic) else value
    return found


def drawn_actions(space: Any, n: int, seed: int) -> list[Any]:
    """Actions drawn once, so that two environments can be played alike."""
    space.seed(seed)
    return [space.sample() for _ in range(n)]


def rollout(env: Any, actions: list[Any], *, reset: bool = True) -> list[Any]:
    """All that an environment gives for actions; it is reset after each end, without a seed."""
    seen = [env.reset()] if reset else []
    for action in actions:
        seen.append(env.step(action))
        if seen[-1][2] or seen[-1][3]:
            seen.append(env.reset())
    return seen
