"""An episode that an agent plays, with its pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents.base import predictor
from gym_babble.envs.interface import outcome_of
from gym_babble.study.evaluation import for_cases, needs_goals

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from gym_babble.agents.base import Agent
    from gym_babble.agents.loading import LoadedAgent
    from gym_babble.envs import BabbleEnv

__all__ = ["Episode", "play"]


@dataclass(frozen=True)
class Episode:
    """An episode from its start to its end. A picture is drawn when it is asked for."""

    agent: Agent
    """The agent that played."""
    env: BabbleEnv
    """The environment, which recorded the episode."""
    observations: list[Any]
    """What the agent saw at each moment; of a whole movement, what it was chosen for."""
    outcome: str
    """How the episode ended."""

    @property
    def moments(self) -> int:
        """Moments of the episode: its start, and each control step."""
        return len(self.observations)

    @property
    def control_hz(self) -> float:
        """Control steps in a second of simulated time."""
        return self.env.interface.spec.control_hz

    @property
    def seconds(self) -> float:
        """Simulated time from start to end [s]."""
        return (self.moments - 1) / self.control_hz

    def pictures(self, size: int, camera: str = "third_person") -> list[NDArray[np.uint8]]:
        """Square pictures (size, size, 3) of all moments."""
        return [self.env.picture(camera, (size, size), k) for k in range(self.moments)]


def play(loaded: LoadedAgent, case: Mapping[str, Any]) -> Episode:
    """Plays one episode, as `evaluate` does.

    Args:
        loaded: The agent and its environment.
        case: The case; one of a region is played there, and a goal is for the goal form alone.

    Raises:
        ScenarioError: The case cannot be played in the agent's environment.
        ActionError: The agent returned no valid action.
    """
    arguments = for_cases(loaded.arguments, [case], {})
    # Where objects are not carried, the same case without its goal is played.
    case = {name: v for name, v in case.items() if name != "goal" or needs_goals(arguments)}
    env = arguments.single(record=True)
    predict = predictor(loaded.agent)
    observation, info = env.reset(seed=0, options={"scenario": case})
    observations: list[Any] = [observation]
    state, start, running = None, True, True
    while running:
        action, state = predict(observation, state, np.array([start]), True)  # noqa: FBT003
        chosen_for = observation
        observation, _, terminated, truncated, info = env.step(action)
        steps = env.moments - len(observations)
        observations += [chosen_for] * (steps - 1) + [observation]
        start, running = False, not (terminated or truncated)
    return Episode(loaded.agent, env, observations, outcome_of(info))
