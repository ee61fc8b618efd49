"""Figure 4: trajectories of the fingertip to 4 targets from 36 starts around each.

Drawing needs the extra `figures`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gym_babble import _core
from gym_babble.agents.base import predictor
from gym_babble.config import config_json
from gym_babble.envs import BabbleReachEnv
from gym_babble.errors import ScenarioError
from gym_babble.viz.style import FAINT, INK, LEFT, RED, RIGHT, row_of_axes, styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike
    from gym_babble.study.scenarios import Scenario

__all__ = ["Trajectory", "draw", "starts_without_case", "switched", "trajectories"]

STARTS = 36
"""Starts around each target."""


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
    """The movements of an agent in `pattern` control. Impossible cases are skipped."""
    env = BabbleReachEnv("rgb_array", control="pattern", reward="sparse", config=config)
    predict, made = predictor(agent), []
    for case in cases:
        try:
            observation, _ = env.reset(options={"scenario": case})
        except ScenarioError:
            continue
        action, _ = predict(observation, None, np.array([True]), True)  # noqa: FBT003
        *_, info = env.step(action)
        b1 = 0.5 + 0.5 * float(action[0])
        made.append(Trajectory(case, env.trajectory, b1, info["outcome"]))
    return made


def switched(case: Scenario) -> Scenario:
    """The case with obstacle and start exchanged, as on the right of Fig. 4."""
    if case["obstacle"] is None:
        raise ScenarioError("obstacle = None: the case has no obstacle to exchange with the start")
    x, y, radius = case["obstacle"]
    return {**case, "start": (x, y), "obstacle": (*case["start"], radius)}


def starts_without_case(config: ConfigLike = "paper") -> NDArray[np.float64]:
    """Starts of Fig. 4 (n, 2) [m] that are out of reach or have the arm inside the obstacle."""
    listed = _core.Task("reach", config_json(config), "{}").cases("fig4", 1, 0, "test", 1)
    angles = 2.0 * np.pi * np.arange(STARTS) / STARTS
    missing = []
    for first in range(0, len(listed), STARTS):
        around = listed[first : first + STARTS]
        known = next((case for case in around if case is not None), None)
        if known is None:
            continue
        target = np.array(known["target"])
        radius = np.linalg.norm(np.array(known["start"]) - target)
        starts = target + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        missing += [start for start, case in zip(starts, around, strict=True) if case is None]
    return np.array(missing).reshape(-1, 2)


@styled
def draw(
    halfway: Sequence[Trajectory],
    exchanged: Sequence[Trajectory],
    missing: NDArray[np.float64] | None = None,
) -> Figure:
    """Draws trajectories with the obstacle halfway, and with obstacle and start exchanged.

    Bold: success; dotted: failure, up to a red cross; blue curves left, orange right; grey crosses:
    starts without a case. Obstacles are not drawn.

    Args:
        halfway: Movements with the obstacle halfway to the target.
        exchanged: Movements with obstacle and start exchanged.
        missing: Starts without a case (n, 2) [m].
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
    if missing is not None and len(missing):
        left.plot(100 * missing[:, 0], 100 * missing[:, 1], "x", ms=3, mew=0.6, color=FAINT)
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
