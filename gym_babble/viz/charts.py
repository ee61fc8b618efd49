"""Charts of a study, one panel each. Needs the extra `figures`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from gym_babble.viz.style import FAINT, GRID, INK, row_of_axes, styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["DASHES", "SERIES", "Band", "Bar", "bands", "bars", "draw_bands", "look"]

SERIES = (
    "#3d7fc1",
    "#d1702a",
    "#3d9970",
    "#9467bd",
    "#c94f57",
    "#1f9ea3",
    "#a07c3b",
    "#c565a5",
)
"""Colours of agents, readable on light and on dark paper."""

DASHES = ("-", "--", ":", "-.")
"""Line styles: the first eight agents have the first, the next eight the second, and so on."""


def look(i: int) -> tuple[str, str]:
    """Colour and line style of the i-th agent."""
    return SERIES[i % len(SERIES)], DASHES[i // len(SERIES) % len(DASHES)]


@dataclass(frozen=True, kw_only=True)
class Band:
    """A line with an interval around it, and the single runs behind it."""

    name: str
    series: int
    """Position of the agent in its study, for the colour."""
    x: Sequence[float]
    middle: Sequence[float]
    low: Sequence[float]
    """Lower ends of the intervals; empty without intervals, as of one seed."""
    high: Sequence[float]
    runs: Sequence[tuple[Sequence[float], Sequence[float]]] = ()
    """x and y of each run."""


@dataclass(frozen=True, kw_only=True)
class Bar:
    """An estimate with its interval, and the single runs."""

    name: str
    series: int
    estimate: float
    low: float | None
    """Lower end of the interval; None if there is none."""
    high: float | None
    runs: Sequence[float]


@styled
def bands(
    lines: Sequence[Band],
    *,
    x: str,
    y: str,
    log: bool = False,
    steps: bool = False,
    dotted: float | None = None,
) -> Figure:
    """Draws lines with their intervals.

    Args:
        lines: The lines.
        x: Label of the horizontal axis.
        y: Label of the vertical axis, which goes from 0 to 1.
        log: Logarithmic horizontal axis.
        steps: Lines go in steps, as of a share that changes at single values.
        dotted: Height of a dotted line, as a value of the paper.
    """
    figure, (ax,) = row_of_axes((4.1, 3.1), 1)
    draw_bands(ax, lines, x=x, y=y, log=log, steps=steps, dotted=dotted)
    return figure


def draw_bands(
    ax: Axes,
    lines: Sequence[Band],
    *,
    x: str,
    y: str,
    log: bool = False,
    steps: bool = False,
    dotted: float | None = None,
) -> None:
    """Draws lines with their intervals into axes; all else is as for `bands`."""
    from matplotlib.ticker import NullFormatter

    for line in lines:
        colour, dash = look(line.series)
        for xs, ys in line.runs:
            ax.plot(xs, ys, color=colour, lw=0.6, alpha=0.45)
        if line.low:
            step: Literal["post"] | None = "post" if steps else None
            ax.fill_between(line.x, line.low, line.high, step=step, color=colour, alpha=0.15, lw=0)
        marker = "." if log else ""
        ax.plot(
            line.x,
            line.middle,
            color=colour,
            ls=dash,
            lw=1.7,
            marker=marker,
            drawstyle="steps-post" if steps else "default",
            label=line.name,
        )
    if dotted is not None:
        ax.axhline(dotted, color=FAINT, lw=1, ls=":")
    ax.set(xlabel=x, ylabel=y, ylim=(-0.02, 1.02))
    if log and lines:
        ax.set_xscale("log")
        ax.xaxis.set_minor_formatter(NullFormatter())
    ax.grid(axis="y", color=GRID, lw=0.6)


@styled
def bars(rows: Sequence[Bar], *, x: str, dotted: float | None = None) -> Figure:
    """Draws a bar from the low to the high end of each interval, and a dot for each run.

    Args:
        rows: The estimates, from above.
        x: Label of the horizontal axis, which goes from 0 to 1.
        dotted: A value of the paper, as a dotted line.
    """
    figure, (ax,) = row_of_axes((5.0, 0.75 + 0.36 * len(rows)), 1)
    for i, row in enumerate(rows):
        _bar(ax, i, row)
    if dotted is not None:
        ax.axvline(dotted, color=FAINT, lw=1, ls=":", zorder=0)
    ax.set(xlabel=x, xlim=(-0.02, 1.02), ylim=(len(rows) - 0.5, -0.5))
    ax.set_yticks(range(len(rows)), [row.name for row in rows])
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    ax.grid(axis="x", color=GRID, lw=0.6)
    ax.set_axisbelow(True)
    return figure


def _bar(ax: Axes, i: int, row: Bar) -> None:
    """One row: the interval as a broad bar, the estimate as a stroke, the runs as dots below."""
    colour, _ = look(row.series)
    if row.low is not None and row.high is not None:
        width = max(row.high - row.low, 0.004)
        ax.barh(i, width, left=row.low, height=0.34, color=colour, alpha=0.35, lw=0)
    ax.plot([row.estimate] * 2, [i - 0.26, i + 0.26], color=colour, lw=2)
    spread = np.linspace(-0.1, 0.1, len(row.runs)) if len(row.runs) > 1 else np.zeros(1)
    places = (i + spread).tolist()
    ax.plot(list(row.runs), places, "o", ms=2.8, mfc=INK, mec="none", alpha=0.8, zorder=3)
