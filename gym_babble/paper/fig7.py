"""Figure 7: final portions of the palm's trajectories to objects all around.

Drawing needs the extra `figures`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gym_babble.agents.base import predictor
from gym_babble.agents.loading import acting_agent
from gym_babble.progress import track
from gym_babble.study.evaluation import for_cases
from gym_babble.viz.style import FAINT, INK, LEFT, OBJECT, RED, row_of_axes, styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gym_babble.agents.base import Agent
    from gym_babble.study.scenarios import GraspScenario

__all__ = ["PalmTrajectory", "draw", "trajectories"]

TEST_STEPS = 240
"""Time limit of a test [control steps]."""


class PalmTrajectory(NamedTuple):
    """One test of Fig. 7."""

    case: GraspScenario
    palm: NDArray[np.float64]
    """Positions of the palm's centre (k, 2) [m]."""
    reach: bool
    """Whether any part of arm or hand touched the object."""
    held: bool
    """Whether the hand held the object without support."""


def trajectories(
    agent: Agent,
    cases: Sequence[GraspScenario],
    *,
    progress_bar: bool = False,
) -> list[PalmTrajectory]:
    """The palm's trajectories in tests of an agent, on its own body.

    Raises:
        ScenarioError: Cases of another config than the agent's.
    """
    limit = {"max_episode_steps": TEST_STEPS}
    loaded = acting_agent(agent, options=limit)
    env = for_cases(loaded.arguments, cases, limit).single("rgb_array")
    predict, made = predictor(loaded.agent), []
    parts = track([1] * len(cases), "testing", total=len(cases), show=progress_bar)
    for case, _ in zip(cases, parts, strict=True):
        observation, info = env.reset(seed=0, options={"scenario": case})
        state, start, ended = None, True, False
        while not ended:
            action, state = predict(observation, state, np.array([start]), True)  # noqa: FBT003
            observation, _, terminated, truncated, info = env.step(action)
            start, ended = False, terminated or truncated
        made.append(PalmTrajectory(case, env.trajectory, info["reach"], info["held"]))
    return made


@styled
def draw(movements: Sequence[PalmTrajectory], last_m: float = 0.06) -> Figure:
    """Draws the final portions of the trajectories, in one plot for each diameter.

    Thin: touched; bold: grasped; dotted grey: missed. Circles are the objects, to scale.

    Args:
        movements: The tests to draw.
        last_m: Length of the final portion [m].
    """
    from matplotlib.patches import Circle

    diameters = sorted({one.case["diameter"] for one in movements})
    size = (4.6 * len(diameters), 4.4)
    figure, axes = row_of_axes(size, len(diameters), sharex=True, sharey=True)
    for ax, diameter in zip(axes, diameters, strict=True):
        chosen = [one for one in movements if one.case["diameter"] == diameter]
        for x, y in sorted({one.case["object"] for one in chosen}):
            circle = Circle((100 * x, 100 * y), 50 * diameter, fc=OBJECT, ec=RED, lw=0.8)
            ax.add_patch(circle)
        for one in chosen:
            _draw_final_portion(ax, one, last_m)
        ax.plot(0, 0, "s", ms=6, color=INK, zorder=4)
        ax.annotate("shoulder", (0, 0), xytext=(6, -10), textcoords="offset points")
        reached, held = (sum(getattr(one, name) for one in chosen) for name in ("reach", "held"))
        title = f"{100 * diameter:g} cm: {reached} of {len(chosen)} reached, {held} grasped"
        ax.set(title=title, xlabel="x [cm]", aspect="equal")
    axes[0].set_ylabel("y [cm]")
    return figure


def _draw_final_portion(ax: Axes, movement: PalmTrajectory, last_m: float) -> None:
    path = movement.palm
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    to_go = steps.sum() - np.concatenate([[0.0], np.cumsum(steps)])
    path = 100 * path[to_go <= last_m]
    if movement.held:
        ax.plot(path[:, 0], path[:, 1], color=LEFT, lw=2.6, zorder=3, solid_capstyle="round")
    elif movement.reach:
        ax.plot(path[:, 0], path[:, 1], color=LEFT, lw=0.9)
    else:
        ax.plot(path[:, 0], path[:, 1], color=FAINT, lw=0.8, ls=":")
