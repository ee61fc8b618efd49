"""Figure 2: paths of the pattern generators. Needs the extra `figures`."""

from __future__ import annotations

from math import cos, pi, sin, sqrt
from typing import TYPE_CHECKING

import numpy as np

from gym_babble import _core
from gym_babble.viz.style import FAINT, INK, LEFT, RED, RIGHT, row_of_axes, styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

__all__ = ["draw"]


@styled
def draw(b1: Sequence[float] = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)) -> Figure:
    """Paths for b2 = 1 − b1 (Eq. 5), and the same turned and scaled to a target (Eq. 6)."""
    figure, (left, right) = row_of_axes((9.5, 4.4), 2)
    theta, distance_m = 100 * pi / 180, 0.2
    turn = theta - pi / 4
    rotation = np.array([[cos(turn), -sin(turn)], [sin(turn), cos(turn)]])
    for value in b1:
        path = _core.generator_curve(value, 1.0 - value, 200)
        colour = FAINT if value == 0.5 else LEFT if value > 0.5 else RIGHT
        width = 0.8 + 2.0 * abs(value - 0.5)
        left.plot(path[:, 0], path[:, 1], color=colour, lw=width, label=f"{value:g}")
        placed = 100 * distance_m / sqrt(2) * path @ rotation.T
        right.plot(placed[:, 0], placed[:, 1], color=colour, lw=width)
        middle = path[len(path) // 2]
        left.annotate(
            f"{value:g}",
            middle,
            fontsize=7,
            color=INK,
            ha="center",
            va="center",
            bbox={"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none"},
        )
    left.set(title="Generators (Eq. 5), by b1", xlabel="cx", ylabel="cy", aspect="equal")
    end = 100 * distance_m * np.array([cos(theta), sin(theta)])
    right.plot([0], [0], "o", color=INK, ms=4)
    right.plot(*end, "o", mfc="none", color=RED, ms=9)
    right.annotate("hand", (0, 0), xytext=(7, -3), textcoords="offset points")
    right.annotate("target", tuple(end), xytext=(9, 3), textcoords="offset points")
    right.set(title="Turned and scaled (Eq. 6)", xlabel="x [cm]", ylabel="y [cm]", aspect="equal")
    right.set(xticks=(-10, -5, 0, 5, 10), yticks=(0, 5, 10, 15, 20))
    return figure
