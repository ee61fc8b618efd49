"""Draws docs/images/changed_body.png from its store: `python -m results.changed_body`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.viz.charts import look
from gym_babble.viz.style import GRID, INK, row_of_axes, save, styled
from results.stores import ROOT, Stores

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PICTURE = ROOT / "docs" / "images" / "changed_body.png"


@styled
def draw(rows: list[dict[str, Any]]) -> Figure:
    """A panel for each agent, a row for each change.

    Success at once, after learning on, and of agents that learnt there alone.
    """
    agents = list(dict.fromkeys(row["agent"] for row in rows))
    changes = list(dict.fromkeys(row["change"] for row in rows))
    figure, panels = row_of_axes((8.4, 0.9 + 0.3 * len(changes)), len(agents), sharey=True)
    for i, (ax, agent) in enumerate(zip(panels, agents, strict=True)):
        for row in rows:
            if row["agent"] == agent:
                _mark(ax, changes.index(row["change"]), row, look(i)[0])
        ax.set(title=agent.replace("`", ""), xlim=(0, 1.02), ylim=(len(changes) - 0.5, -0.5))
        ax.set_yticks(range(len(changes)), changes)
        ax.tick_params(axis="y", length=0)
        ax.spines["left"].set_visible(False)
        ax.grid(axis="x", color=GRID, lw=0.6)
        ax.set_axisbelow(True)
    panels[len(panels) // 2].set_xlabel("success")
    _explain(figure)
    return figure


def _mark(ax: Axes, y: int, row: dict[str, Any], colour: str) -> None:
    """A mark of one budget: open at once, larger after more movements, a line for `None`."""
    x, budget = row["success"], row["movements"]
    if budget is None:
        ax.plot([x, x], [y - 0.32, y + 0.32], color=INK, lw=1.4)
    elif budget == 0:
        ax.plot(x, y, "o", ms=6.5, mfc="none", mec=colour, mew=1.3)
    else:
        ax.plot(x, y, "o", ms=2.5 * (budget / 250) ** 0.3, mfc=colour, mec="none")


def _explain(figure: Figure) -> None:
    """The legend below the panels."""
    from matplotlib.lines import Line2D

    def dot(size: float, label: str, fill: str = INK) -> Line2D:
        return Line2D([], [], ls="", marker="o", mec=INK, mfc=fill, ms=size, label=label)

    figure.legend(
        handles=[
            dot(6.5, "at once", "none"),
            dot(3.2, "after a few movements"),
            dot(6, "after more"),
            Line2D([], [], color=INK, lw=1.4, label="learnt there alone"),
        ],
        loc="outside lower center",
        ncols=4,
    )


def main() -> None:
    """Draws the picture."""
    runs = Stores()["changed_body"].values()
    save(draw([row for run in runs for row in run]), PICTURE)


if __name__ == "__main__":
    main()
