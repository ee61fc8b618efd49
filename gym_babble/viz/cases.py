"""One case with the ways of several agents. Needs the extra `figures`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gym_babble.viz.charts import look
from gym_babble.viz.style import FAINT, INK, RED, row_of_axes, styled

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Way", "case_panel"]


class Way(NamedTuple):
    """The way of an agent's hand in a case."""

    series: int
    """Position of the agent in its study, for colour and line style."""
    path: Sequence[Sequence[float]]
    """Positions [x, y] of fingertip or palm [m]."""
    success: bool


@styled
def case_panel(case: Mapping[str, Any], ways: Sequence[Way], title: str) -> Figure:
    """Draws obstacle, start, and target or object of a case, and the ways of agents.

    Thick: success; thin, up to a red cross: failure.

    Args:
        case: A case, as `scenarios` gives it.
        ways: The ways.
        title: Title of the panel.
    """
    from matplotlib.patches import Circle

    figure, (ax,) = row_of_axes((3.4, 3.0), 1)
    if case["obstacle"] is not None:
        x, y, radius = (100 * value for value in case["obstacle"])
        ax.add_patch(Circle((x, y), radius, fc=FAINT, ec="none", alpha=0.45))
    if "object" in case:
        middle = tuple(100 * value for value in case["object"])
        ax.add_patch(Circle(middle, 50 * case["diameter"], fc=RED, ec=RED, alpha=0.25))
    else:
        ax.plot(*(100 * value for value in case["target"]), "o", ms=9, mfc="none", mec=RED, mew=1.4)
    for way in ways:
        _draw(ax, way)
    ax.set(title=title, xlabel="x [cm]", ylabel="y [cm]", aspect="equal")
    ax.set_adjustable("datalim")
    ax.margins(0.08)
    ax.locator_params(nbins=5)
    return figure


def _draw(ax: Axes, way: Way) -> None:
    colour, dash = look(way.series)
    path = 100 * np.array(way.path)
    ax.plot(path[:, 0], path[:, 1], color=colour, ls=dash, lw=2.0 if way.success else 1.0)
    ax.plot(*path[0], "o", ms=3, color=INK, zorder=3)
    if not way.success:
        ax.plot(*path[-1], "x", ms=5, color=RED, zorder=4)
