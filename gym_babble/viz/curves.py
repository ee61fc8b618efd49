"""Learning curves of a comparison. Needs the extra `figures`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gym_babble.viz.style import FAINT, INK, row_of_axes, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gym_babble.study.comparison import Comparison

__all__ = ["learning_curves"]

COLOURS = {
    "hebb-paper": "#1f6fb2",
    "hebb-conjunctive": "#0b3c66",
    "ppo-obstacle": "#e0a050",
    "ppo-pattern": "#c2571a",
    "ppo-posture": "#7a2e0b",
    "ppo-stored": "#c2571a",
}


@styled
def learning_curves(comparison: Comparison) -> Figure:
    """Success on validation cases against control steps and against clock time."""
    from matplotlib.ticker import NullFormatter

    figure, (left, right) = row_of_axes((9.5, 4.2), 2, sharey=True)
    paper = comparison.task.paper
    for result in comparison.results:
        colour = COLOURS.get(result.contender.key, INK)
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
    for ax, label in ((left, "control steps"), (right, "learning time [s]")):
        if paper is not None:
            ax.axhline(paper["success"] / sum(paper.values()), color=FAINT, lw=1, ls=":")
        ax.set(xscale="log", xlabel=label, ylim=(0, 1))
        ax.xaxis.set_minor_formatter(NullFormatter())
        ax.grid(axis="y", color="#e4e7eb", lw=0.6)
    left.set_ylabel("success on validation cases")
    figure.legend(*right.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
