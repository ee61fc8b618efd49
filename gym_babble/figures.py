"""Figures like the paper's 2, 4 and 5, and learning curves. They need the extra `figures`."""

from __future__ import annotations

from functools import wraps
from io import BytesIO
from math import cos, pi, sin, sqrt
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np

from gym_babble import _core
from gym_babble.errors import ConfigError, MissingExtraError
from gym_babble.tables import PAPER

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gym_babble.compare import Comparison
    from gym_babble.reproduce import Way, WeightSets

__all__ = ["check_format", "fig2", "fig4", "fig5", "learning_curves", "save", "svg"]

P = ParamSpec("P")
T = TypeVar("T")

INK, FAINT, RED = "#1f2933", "#9aa5b1", "#b42318"
LEFT, RIGHT = "#1f6fb2", "#c2571a"
LINES = {
    "hebb-paper": "#1f6fb2",
    "hebb-conjunctive": "#0b3c66",
    "ppo-obstacle": "#e0a050",
    "ppo-pattern": "#c2571a",
    "ppo-posture": "#7a2e0b",
}
STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.frameon": False,
    "text.color": INK,
    "svg.hashsalt": "gym-babble",  # The same figure is the same file.
}


def _matplotlib() -> Any:
    try:
        import matplotlib as mpl
    except ImportError as error:
        raise MissingExtraError("matplotlib", "figures") from error
    return mpl


def _styled(draw: Callable[P, T]) -> Callable[P, T]:
    """Draws in the style of this module, whatever the user's own settings."""

    @wraps(draw)
    def styled(*args: P.args, **kwargs: P.kwargs) -> T:
        with _matplotlib().rc_context(STYLE):
            return draw(*args, **kwargs)

    return styled


def _axes(size: tuple[float, float], columns: int, **kwargs: Any) -> tuple[Figure, list[Axes]]:
    """A figure with a row of axes; without pyplot, which would keep it and want a display."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(1, columns, squeeze=False, **kwargs)
    return figure, list(axes[0])


@_styled
def svg(figure: Figure) -> bytes:
    """The figure as an SVG file, the same bytes for the same figure."""
    buffer = BytesIO()
    figure.savefig(
        buffer, format="svg", metadata={"Date": None}, transparent=True, bbox_inches="tight"
    )
    return buffer.getvalue()


def check_format(path: Path) -> None:
    """Raises ConfigError if matplotlib writes no files with this ending."""
    _matplotlib()
    from matplotlib.backend_bases import FigureCanvasBase

    known = FigureCanvasBase.get_supported_filetypes()
    if path.suffix.removeprefix(".") not in known:
        raise ConfigError(f"{path}: a picture's name ends with one of {', '.join(sorted(known))}")


@_styled
def save(figure: Figure, path: Path) -> None:
    """Writes the figure in the format of the file's ending (png, svg, pdf ...)."""
    check_format(path)
    figure.savefig(path, dpi=160, bbox_inches="tight")


@_styled
def fig2(b1: Sequence[float] = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)) -> Figure:
    """Paths of the pattern generators for b2 = 1 − b1 (Eq. 5), and turned and scaled (Eq. 6)."""
    figure, (left, right) = _axes((9.5, 4.4), 2)
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


@_styled
def fig4(
    found: Sequence[Way], switched: Sequence[Way], missing: NDArray[np.float64] | None = None
) -> Figure:
    """Ways of the fingertip to 4 targets from 36 starts around each.

    Bold: success; dotted: failure, up to a red cross; blue curves left, orange right; grey crosses:
    starts without a case.
    At the right obstacle and start are in each other's place. Obstacles are not drawn.
    """
    figure, (left, right) = _axes((10.0, 4.2), 2, sharex=True, sharey=True)
    for axes, ways, title in ((left, found, "Obstacle halfway"), (right, switched, "Switched")):
        for way in ways:
            _draw_way(axes, way)
        for x, y in sorted({way.case["target"] for way in ways}):
            axes.plot(100 * x, 100 * y, "o", ms=11, mfc="white", mec=RED, mew=1.6, zorder=4)
        axes.plot(0, 0, "s", ms=6, color=INK, zorder=4)
        axes.annotate("shoulder", (0, 0), xytext=(6, -10), textcoords="offset points")
        good = sum(way.outcome == "success" for way in ways)
        axes.set(title=f"{title}: {good} of {len(ways)} reach", xlabel="x [cm]", aspect="equal")
    if missing is not None and len(missing):
        left.plot(100 * missing[:, 0], 100 * missing[:, 1], "x", ms=3, mew=0.6, color=FAINT)
    left.set_ylabel("y [cm]")
    return figure


def _draw_way(axes: Axes, way: Way) -> None:
    colour = LEFT if way.b1 > 0.5 else RIGHT
    good = way.outcome == "success"
    path = 100 * way.fingertip
    axes.plot(
        path[:, 0],
        path[:, 1],
        color=colour,
        lw=1.8 if good else 1.1,
        ls="-" if good else ":",
        solid_capstyle="round",
    )
    axes.plot(*path[0], "o", ms=3, color=INK, zorder=3)
    if not good:
        axes.plot(*path[-1], "x", ms=4, color=RED, zorder=3)


@_styled
def fig5(sets: WeightSets, w_max: float = 0.2) -> Figure:
    """Weights to the output map: one neuron and the mean of each set; and where the sets lie."""
    figure, axes = _axes((11.0, 2.7), 5, width_ratios=(1, 1, 1, 1, 1.1))
    left, right = sets.typical(sets.left), sets.typical(sets.right)
    shown = (
        (sets.patterns[left], f"Neuron {left}: left"),
        (sets.mean(sets.left), f"Mean of {sets.left.sum()} left"),
        (sets.patterns[right], f"Neuron {right}: right"),
        (sets.mean(sets.right), f"Mean of {sets.right.sum()} right"),
    )
    for ax, (pattern, title) in zip(axes, shown, strict=False):
        picture = ax.imshow(
            pattern, origin="lower", extent=(0, 1, 0, 1), cmap="RdBu_r", vmin=-w_max, vmax=w_max
        )
        ax.set(title=title, xlabel="b1", xticks=(0, 0.5, 1), yticks=(0, 0.5, 1))
    axes[0].set_ylabel("b2")
    figure.colorbar(picture, ax=axes[:4], shrink=0.7, pad=0.01, label="weight")
    _draw_sets(axes[4], sets)
    return figure


def _draw_sets(ax: Axes, sets: WeightSets) -> None:
    from matplotlib.colors import ListedColormap

    members = np.where(sets.left, 1, np.where(sets.right, 2, 0))
    colours = ListedColormap(["#eef1f4", LEFT, RIGHT])
    ax.imshow(members, origin="lower", extent=(-60, 60, -60, 60), cmap=colours, vmin=0, vmax=2)
    ax.set(
        title="Input neurons",
        xlabel="obstacle, azimuth [°]",
        ylabel="elevation [°]",
        xticks=(-60, 0, 60),
        yticks=(-60, 0, 60),
    )


@_styled
def learning_curves(comparison: Comparison) -> Figure:
    """Success on validation cases over the control steps simulated and over clock time."""
    from matplotlib.ticker import NullFormatter

    figure, (left, right) = _axes((9.5, 4.2), 2, sharey=True)
    for result in comparison.results:
        colour = LINES.get(result.contender.key, INK)
        name = f"{result.contender.title}, {result.contender.detail}"
        for i, trained in enumerate(result.trained):
            if not trained.curve:
                continue
            success = [point.success for point in trained.curve]
            for ax, x in (
                (left, [point.control_steps for point in trained.curve]),
                (right, [point.seconds for point in trained.curve]),
            ):
                ax.plot(x, success, ".-", color=colour, lw=1.5, label=None if i else name)
    for ax, label in ((left, "control steps simulated"), (right, "seconds of learning")):
        ax.axhline(PAPER["success"] / 1000, color=FAINT, lw=1, ls=":")
        ax.set(xscale="log", xlabel=label, ylim=(0, 1))
        ax.xaxis.set_minor_formatter(NullFormatter())
        ax.grid(axis="y", color="#e4e7eb", lw=0.6)
    left.set_ylabel("success on validation cases")
    figure.legend(*right.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
