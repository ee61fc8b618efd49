"""Ways of the hand in an agent's first cases, small enough to store with each run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents.base import predictor
from gym_babble.envs.interface import outcome_of
from gym_babble.study.evaluation import for_cases

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.agents.loading import LoadedAgent

__all__ = ["SHOWN_CASES", "hand_paths"]

SHOWN_CASES = 12
"""Cases whose ways are stored, the first ones of a test."""

MOST_POINTS = 30
"""Points of a stored way; of longer ones equally spaced points are kept, the last one too."""


def hand_paths(loaded: LoadedAgent, cases: Sequence[Any]) -> list[dict[str, Any]]:
    """Plays cases one by one, as JSON types.

    Args:
        loaded: The agent and its environment.
        cases: Cases of one protocol.

    Returns:
        For each case `outcome`, and `path`: positions [x, y] of the fingertip in reaching and of
        the palm in grasping [m], to a tenth of a millimetre.
    """
    arguments = for_cases(loaded.arguments, cases, loaded.arguments.options)
    env, predict, shown = arguments.single("rgb_array"), predictor(loaded.agent), []
    for case in cases:
        observation, info = env.reset(seed=0, options={"scenario": case})
        state, start, ended = None, True, False
        while not ended:
            action, state = predict(observation, state, np.array([start]), True)  # noqa: FBT003
            observation, _, terminated, truncated, info = env.step(action)
            start, ended = False, terminated or truncated
        path = env.trajectory
        kept = np.linspace(0, len(path) - 1, min(MOST_POINTS, len(path))).round().astype(int)
        shown.append({"outcome": outcome_of(info), "path": path[kept].round(4).tolist()})
    env.close()
    return shown
