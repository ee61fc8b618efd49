"""The sections that show what agents do: ways of the hand, films, weights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.report.agents import hebb_sections
from gym_babble.report.charts import Chart
from gym_babble.report.strips import strip_section
from gym_babble.viz.cases import Way, case_panel

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gym_babble.report.data import TaskRuns

__all__ = ["sections_of"]

PANELS = 6
"""Cases whose ways are drawn, the first ones of the test."""


def sections_of(task: TaskRuns) -> Iterator[dict[str, Any]]:
    """The sections of a task: `title`, `text`, `legend`, and charts and pictures."""
    charts = _ways(task)
    if charts:
        yield {
            "title": "The same cases, all agents",
            "text": f"The first {len(charts)} test cases with the way of the hand of each agent's "
            "first seed. Thick: success; thin, up to a red cross: failure. "
            f"{'Grey: the obstacle.' if task.spec.task == 'reach' else 'Red: the object.'}",
            "legend": True,
            "panels": charts,
            "broad": [],
            "photos": [],
        }
    yield from strip_section(task)
    yield from hebb_sections(task)


def _ways(task: TaskRuns) -> list[Chart]:
    """A panel for each of the first cases, with the ways of all agents' first seeds."""
    agents = [agent for agent in task.agents if "paths" in agent.records[0]]
    if not agents:
        return []
    cases = agents[0].runs[0].spec.cases()[:PANELS]
    charts = []
    for i, case in enumerate(cases):
        shown = [(agent.series, agent.records[0]["paths"][i]) for agent in agents]
        ways = [Way(series, one["path"], one["outcome"] == "success") for series, one in shown]
        figure = case_panel(case, ways, f"Case {i}")
        reached = sum(way.success for way in ways)
        caption = f"Case {i}: {reached} of {len(ways)} agents succeed."
        charts.append(Chart(f"{task.name}.case{i}", figure, caption))
    return charts
