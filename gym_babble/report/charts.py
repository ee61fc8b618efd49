"""The charts of a task, drawn from its numbers. Needs the extra `figures`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from gym_babble.report.texts import axis_words
from gym_babble.viz.charts import Band, Bar, bands, bars

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Chart", "band_of", "final_charts", "learning_charts"]


class Chart(NamedTuple):
    """A chart and what it shows."""

    name: str
    """Name of its file, without the ending."""
    figure: Figure
    caption: str


def final_charts(task: dict[str, Any]) -> list[Chart]:
    """Success in the final test, and performance profiles."""
    paper = (task["paper"] or {}).get("success")
    rows = [
        Bar(
            name=agent["title"],
            series=agent["series"],
            **agent["success"]["iqm"],
            runs=[run["rates"]["success"]["rate"] for run in agent["runs"]],
        )
        for agent in task["agents"]
    ]
    dotted = " Dotted: the paper." if paper is not None else ""
    lines = [
        Band(
            name=agent["title"],
            series=agent["series"],
            x=profile["thresholds"],
            middle=profile["shares"],
            low=profile["low"],
            high=profile["high"],
        )
        for agent in task["agents"]
        if (profile := task["profiles"][agent["label"]])
    ]
    return [
        Chart(
            f"{task['name']}.success",
            bars(rows, x="success in the final test", dotted=paper),
            "Success in the final test. Dots: single runs. Stroke: interquartile mean of the "
            f"seeds. Bar: its 95 % interval.{dotted}",
        ),
        Chart(
            f"{task['name']}.profiles",
            bands(lines, x="success rate", y="share of seeds above it", steps=True),
            "Performance profiles: the share of an agent's seeds that succeed more often than the "
            "rate below. Bands: 95 % intervals at each rate.",
        ),
    ]


def learning_charts(task: dict[str, Any]) -> list[Chart]:
    """Learning curves over trials, control steps and CPU seconds; none if nobody learnt."""
    learners = [agent for agent in (*task["agents"], *task["joined"]) if agent["curve"]]
    if not learners:
        return []
    paper = (task["paper"] or {}).get("success")
    charts = []
    for axis in dict.fromkeys(axis for agent in learners for axis in agent["curve"]):
        words = axis_words(task, axis)
        lines = [band_of(agent, axis) for agent in learners if axis in agent["curve"]]
        figure = bands(lines, x=words, y="success at checkpoints", log=True, dotted=paper)
        charts.append(Chart(f"{task['name']}.curve.{axis}", figure, f"Success against {words}."))
    return charts


def band_of(agent: dict[str, Any], axis: str) -> Band:
    """The learning curve of an agent along an axis."""
    points, runs = agent["curve"][axis]["points"], agent["curve"][axis]["runs"]
    sure = [one for one in points if one["low"] is not None]
    return Band(
        name=agent["title"],
        series=agent["series"],
        x=[one["cost"] for one in points],
        middle=[one["estimate"] for one in points],
        low=[one["low"] for one in sure],
        high=[one["high"] for one in sure],
        runs=[(one["cost"], one["success"]) for one in runs] if len(runs) > 1 else (),
    )
