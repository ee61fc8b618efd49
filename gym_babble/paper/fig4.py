"""Figure 4: trajectories of the fingertip to 4 targets from 36 starts around each.

Drawing needs the extra `figures`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import gymnasium
import numpy as np

from gym_babble.agents import Random, Scripted
from gym_babble.agents.base import predictor
from gym_babble.envs import BabbleReachEnv
from gym_babble.envs.interface import outcome_of
from gym_babble.errors import ScenarioError
from gym_babble.study.evaluation import evaluate
from gym_babble.study.scenarios import scenarios
from gym_babble.viz.style import INK, LEFT, RED, RIGHT, row_of_axes, styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gym_babble.agents.base import Agent, EnvLike
    from gym_babble.config import ConfigLike
    from gym_babble.study.scenarios import Scenario

__all__ = ["Straight", "Trajectory", "draw", "reached", "switched", "trajectories"]


class Trajectory(NamedTuple):
    """One movement of Fig. 4."""

    case: Scenario
    fingertip: NDArray[np.float64]
    """Positions of the fingertip (k, 2) [m]."""
    b1: float
    """Parameter of the movement; above ½ the path curves to the left."""
    outcome: str
    """How the movement ended."""


def trajectories(
    agent: Agent, cases: Sequence[Scenario], config: ConfigLike = "paper"
) -> list[Trajectory]:
    """The movements of an agent in `pattern` control."""
    env = BabbleReachEnv("rgb_array", control="pattern", reward="sparse", config=config)
    predict, made = predictor(agent), []
    for case in cases:
        observation, _ = env.reset(options={"scenario": case})
        action, _ = predict(observation, None, np.array([True]), True)  # noqa: FBT003
        *_, info = env.step(action)
        b1 = 0.5 + 0.5 * float(action[0])
        made.append(Trajectory(case, env.trajectory, b1, outcome_of(info)))
    return made


def switched(case: Scenario) -> Scenario:
    """The case with obstacle and start exchanged, as on the right of Fig. 4."""
    if case["obstacle"] is None:
        raise ScenarioError("obstacle = None: the case has no obstacle to exchange with the start")
    x, y, radius = case["obstacle"]
    return {**case, "start": (x, y), "obstacle": (*case["start"], radius)}


class Straight:
    """Moves straight to the target, b1 = b2 = ½."""

    def __init__(self, env: EnvLike) -> None:
        self.env = env

    def predict(self, observation: Any) -> NDArray[np.float32]:  # noqa: ARG002
        """The same action for every observation."""
        return np.zeros(2, np.float32)


def reached(agent: Agent, seed: int = 0, config: ConfigLike = "paper") -> dict[str, Any]:
    """How many movements reach the target on the left and on the right of Fig. 4.

    Counts of the agent, and of agents that show what the panels demand: a straight movement, a
    random one, and one that curves to the shoulder.
    """
    halfway = scenarios("fig4", config=config)
    panels = {"halfway": halfway, "switched": [switched(case) for case in halfway]}
    env = gymnasium.make("BabbleReachPattern-v0", config=config)
    agents: dict[str, Any] = {
        "agent": agent,
        "straight": Straight(env),
        "random": Random(env, seed=seed),
        "scripted": Scripted(env),
    }
    counts = {
        name: {
            panel: evaluate(one, cases=cases, config=config).count("success")
            for panel, cases in panels.items()
        }
        for name, one in agents.items()
    }
    return {"cases": len(halfway), "reached": counts}


@styled
def draw(
    halfway: Sequence[Trajectory],
    exchanged: Sequence[Trajectory],
) -> Figure:
    """Draws trajectories with the obstacle halfway, and with obstacle and start exchanged.

    Bold: success; dotted: failure, up to a red cross; blue curves left, orange right. Obstacles are
    not drawn.

    Args:
        halfway: Movements with the obstacle halfway to the target.
        exchanged: Movements with obstacle and start exchanged.
    """
    figure, (left, right) = row_of_axes((10.0, 4.2), 2, sharex=True, sharey=True)
    for axes, movements, title in (
        (left, halfway, "Obstacle halfway"),
        (right, exchanged, "Switched"),
    ):
        for movement in movements:
            _draw_movement(axes, movement)
        for x, y in sorted({movement.case["target"] for movement in movements}):
            axes.plot(100 * x, 100 * y, "o", ms=11, mfc="white", mec=RED, mew=1.6, zorder=4)
        axes.plot(0, 0, "s", ms=6, color=INK, zorder=4)
        axes.annotate("shoulder", (0, 0), xytext=(6, -10), textcoords="offset points")
        reached = sum(movement.outcome == "success" for movement in movements)
        axes.set(
            title=f"{title}: {reached} of {len(movements)} reach", xlabel="x [cm]", aspect="equal"
        )
    left.set_ylabel("y [cm]")
    return figure


def _draw_movement(axes: Axes, movement: Trajectory) -> None:
    colour = LEFT if movement.b1 > 0.5 else RIGHT
    success = movement.outcome == "success"
    path = 100 * movement.fingertip
    axes.plot(
        path[:, 0],
        path[:, 1],
        color=colour,
        lw=1.8 if success else 1.1,
        ls="-" if success else ":",
        solid_capstyle="round",
    )
    axes.plot(*path[0], "o", ms=3, color=INK, zorder=3)
    if not success:
        axes.plot(*path[-1], "x", ms=4, color=RED, zorder=3)
