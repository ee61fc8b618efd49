"""Figures like the paper's 2, 4 and 5, and learning curves. They need the extra `figures`."""

from __future__ import annotations

from functools import wraps
from io import BytesIO
from math import cos, pi, sin, sqrt
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np

from gym_babble import _core
from gym_babble.errors import ConfigError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gym_babble.agents import HebbGrasping
    from gym_babble.paper.reproduce import Way, WeightSets
    from gym_babble.paper.table2 import GraspWay
    from gym_babble.study.compare import Comparison

__all__ = [
    "check_format",
    "fig2",
    "fig4",
    "fig5",
    "fig7",
    "fig8",
    "learning_curves",
    "save",
    "sight",
    "svg",
]

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
    "ppo-stored": "#c2571a",
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
def fig7(ways: Sequence[GraspWay], last_m: float = 0.06) -> Figure:
    """Final portions of the palm's ways, one plot for each diameter.

    Thin: the object was touched; bold: it was grasped; dotted grey: it was missed. Circles are the
    objects, in their size.
    """
    from matplotlib.patches import Circle

    diameters = sorted({way.case["diameter"] for way in ways})
    size = (4.6 * len(diameters), 4.4)
    figure, axes = _axes(size, len(diameters), sharex=True, sharey=True)
    for ax, diameter in zip(axes, diameters, strict=True):
        chosen = [way for way in ways if way.case["diameter"] == diameter]
        for x, y in sorted({way.case["object"] for way in chosen}):
            circle = Circle((100 * x, 100 * y), 50 * diameter, fc="#fbe3e0", ec=RED, lw=0.8)
            ax.add_patch(circle)
        for way in chosen:
            _draw_grasp(ax, way, last_m)
        ax.plot(0, 0, "s", ms=6, color=INK, zorder=4)
        ax.annotate("shoulder", (0, 0), xytext=(6, -10), textcoords="offset points")
        reached, held = (sum(getattr(way, name) for way in chosen) for name in ("reach", "held"))
        title = f"{100 * diameter:g} cm: {reached} of {len(chosen)} reached, {held} grasped"
        ax.set(title=title, xlabel="x [cm]", aspect="equal")
    axes[0].set_ylabel("y [cm]")
    return figure


def _draw_grasp(ax: Axes, way: GraspWay, last_m: float) -> None:
    path = way.palm
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    to_go = steps.sum() - np.concatenate([[0.0], np.cumsum(steps)])
    path = 100 * path[to_go <= last_m]
    if way.held:
        ax.plot(path[:, 0], path[:, 1], color=LEFT, lw=2.6, zorder=3, solid_capstyle="round")
    elif way.reach:
        ax.plot(path[:, 0], path[:, 1], color=LEFT, lw=0.9)
    else:
        ax.plot(path[:, 0], path[:, 1], color=FAINT, lw=0.8, ls=":")


@_styled
def fig8(agent: HebbGrasping, eye: tuple[float, float] = (0.45, 0.85)) -> Figure:
    """The arm's map when an object is seen, weights of an eye neuron, and of two hand neurons.

    Top left: activation potential of the arm's map for an object at `eye` (pan and tilt over their
    ranges). Top right: weights from the eye neuron nearest to it. Bottom: weights from the fovea to
    the hand neurons nearest to the mean babbled hand, for the smallest and the biggest object.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.6, 7.2), layout="constrained")
    weights, side = agent.weights, agent.config["neurons"]
    reach = weights["reach.weights"]
    potential = (reach @ _tuning(eye, side, agent.config["sigma"])).reshape(side, side)
    grid = np.arange(1, side + 1)
    surface: Any = figure.add_subplot(2, 2, 1, projection="3d")
    surface.plot_surface(*np.meshgrid(grid, grid), potential, cmap="RdBu_r", lw=0.2, ec=FAINT)
    surface.set(title="Arm's map: activation potential", xlabel="shoulder", ylabel="elbow")
    column, row = (round(share * (side - 1)) for share in eye)
    outward = reach[:, row * side + column].reshape(side, side)
    title = f"From eye neuron ({column + 1}, {row + 1})"
    _weights(figure, 2, outward, title=title, axes=("shoulder", "elbow"))
    left = agent.babbled
    diameters = np.unique(left["diameter"])
    for place, diameter in ((3, diameters[0]), (4, diameters[-1])):
        hand = left["hand"][left["diameter"] == diameter].mean(axis=0)
        thumb, finger = (round(np.clip(ep / 90.0, 0.0, 1.0) * (side - 1)) for ep in hand.tolist())
        inward = weights["grasp.weights"][finger * side + thumb].reshape(21, 21)[::-1]
        title = f"To the hand of {100 * diameter:g} cm: EP {hand[0]:.0f}°, {hand[1]:.0f}°"
        _weights(figure, place, inward, title=title, axes=("fovea, column", "row from below"))
    return figure


def _tuning(value: tuple[float, float], side: int, sigma: float) -> NDArray[np.float64]:
    """Activities of a map over [0, 1]², Eq. 3."""
    grid = np.arange(side)
    x, y = (np.exp(-((grid - share * (side - 1)) ** 2) / (2 * sigma**2)) for share in value)
    activity: NDArray[np.float64] = np.outer(y, x).ravel()
    return activity


def _weights(
    figure: Figure, place: int, weights: NDArray[np.float32], *, title: str, axes: tuple[str, str]
) -> None:
    ax = figure.add_subplot(2, 2, place)
    most = float(np.abs(weights).max()) or 1.0
    side = len(weights)
    extent = (0.5, side + 0.5, 0.5, side + 0.5)
    picture = ax.imshow(
        weights, origin="lower", extent=extent, cmap="RdBu_r", vmin=-most, vmax=most
    )
    ticks = {"xticks": (1, 11, 21), "yticks": (1, 11, 21)}
    ax.set(title=title, xlabel=axes[0], ylabel=axes[1], **ticks)
    figure.colorbar(picture, ax=ax, shrink=0.8, label="weight")


@_styled
def sight(pictures: Sequence[tuple[str, Sequence[NDArray[np.uint8]]]]) -> Figure:
    """What the eye sees of objects: a row each with the eye's view, the fovea and its edges."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.4, 2.9 * len(pictures)), layout="constrained")
    titles = ("the eye's view", "fovea, 63 × 63", "edges (Sobel)")
    for row, (name, images) in enumerate(pictures):
        for column, (image, title) in enumerate(zip(images, titles, strict=True)):
            ax = figure.add_subplot(len(pictures), 3, 3 * row + column + 1)
            ax.imshow(image, interpolation="nearest")
            ax.set(title=f"{name}: {title}", xticks=(), yticks=())
    return figure


@_styled
def learning_curves(comparison: Comparison) -> Figure:
    """Success on validation cases over the control steps simulated and over clock time."""
    from matplotlib.ticker import NullFormatter

    figure, (left, right) = _axes((9.5, 4.2), 2, sharey=True)
    paper = comparison.task.paper
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
        if paper is not None:
            ax.axhline(paper["success"] / sum(paper.values()), color=FAINT, lw=1, ls=":")
        ax.set(xscale="log", xlabel=label, ylim=(0, 1))
        ax.xaxis.set_minor_formatter(NullFormatter())
        ax.grid(axis="y", color="#e4e7eb", lw=0.6)
    left.set_ylabel("success on validation cases")
    figure.legend(*right.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
