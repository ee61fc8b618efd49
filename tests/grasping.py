"""A hand that goes straight to the object and closes at the first touch."""

from __future__ import annotations

from typing import Any

import numpy as np

from gym_babble import _core

OPEN = (0.0, 0.0)
INTO_HAND_M = 0.015
"""How much deeper in the hand than against the palm the object is wanted: it is pressed there."""


def posture(env: Any, arm: Any, hand: Any) -> Any:
    """The action of `posture` control for angles of arm and hand [rad]."""
    low, high = env.unwrapped.interface.quantities["ranges"].T
    share = (np.array([*arm, *hand]) - low) / (high - low)
    return np.clip(2 * share - 1, -1, 1).astype(np.float32)


def at(env: Any, place: Any, diameter: float) -> Any:
    """Shoulder and elbow [rad] that bring the palm to a place [m]."""
    found = _core.grasp_posture(
        env.unwrapped.interface.task, tuple(place), diameter / 2 - INTO_HAND_M
    )
    assert found is not None, place
    return found


def to_object(env: Any, info: dict[str, Any]) -> Any:
    """What the hand does in the running episode, whose last info this is."""
    case = env.unwrapped.scenario
    arm = at(env, case["object"], case["diameter"])
    reflex = env.unwrapped.interface.quantities["reflex"]
    return posture(env, arm, reflex if info["reach"] else OPEN)


def grasp(env: Any, **reset: Any) -> list[Any]:
    """All that an episode of the hand gives, the reset first."""
    seen = [env.reset(**reset)]
    while True:
        seen.append(env.step(to_object(env, seen[-1][-1])))
        if seen[-1][2] or seen[-1][3]:
            return seen
