"""The page of a report: its lead, the sections of the task, and how it was made."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from gym_babble.checks import processors
from gym_babble.report.figures import (
    curves_section,
    generators_section,
    hands_section,
    sight_section,
    trajectories_section,
    weights_section,
)
from gym_babble.report.films import grasp_section, movement_section
from gym_babble.report.rates import rates_section
from gym_babble.report.words import WORDS
from gym_babble.study.rates import paper_tally, share
from gym_babble.study.versions import versions

if TYPE_CHECKING:
    from collections.abc import Callable

    from gym_babble.study.comparison import Comparison
    from gym_babble.study.tasks import Task

__all__ = ["page_of"]

SECTIONS: dict[str, tuple[Callable[[Comparison], str], ...]] = {
    "reach": (
        rates_section,
        curves_section,
        movement_section,
        trajectories_section("hebb-paper"),
        trajectories_section("hebb-conjunctive"),
        weights_section,
        generators_section,
    ),
    "grasp": (rates_section, curves_section, grasp_section, hands_section, sight_section),
}
"""The sections of each task's page, after the lead."""


def page_of(comparison: Comparison, command: str, other: str | None) -> str:
    """The whole page."""
    style = Path(__file__).with_name("report.css").read_text(encoding="utf-8")
    task = comparison.task
    sections = "".join(section(comparison) for section in SECTIONS[task.name])
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{task.title}: Hebb babbling beside PPO</title>\n<style>\n{style}</style></head>\n"
        f"<body><main>\n{_lead(comparison)}\n{_link(task, other)}{sections}"
        f"{_provenance(comparison, command)}</main></body></html>\n"
    )


def _link(task: Task, other: str | None) -> str:
    if other is None:
        return ""
    (title,) = (words.heading for name, words in WORDS.items() if name != task.name)
    return f'<p class="note">See also: <a href="{escape(other)}">{title}</a></p>\n'


def _lead(comparison: Comparison) -> str:
    task = comparison.task
    best = [
        f"{escape(result.contender.title)} ({escape(result.contender.detail)}) "
        f"{share(result.rows[0].rates['success']['rate'])}"
        for result in comparison.results
        if result.mean("trials")
    ]
    paper = f"; the paper {share(paper_tally()['success']['rate'])}" if task.paper else ""
    found = f"Success here: {'; '.join(best)}{paper}." if best else ""
    words = WORDS[task.name]
    return f'<h1>{words.heading}</h1>\n<p class="lead">{words.lead} {found}</p>'


def _provenance(comparison: Comparison, command: str) -> str:
    settings, protocol = comparison.settings, comparison.task.protocol
    facts = {
        "config": comparison.to_json()["config"],
        "seeds": ", ".join(map(str, settings.all_seeds)),
        "cases": f"protocol {protocol}, split test, {settings.cases:,} for each seed",
        "processors": str(processors()),
        "time": f"{comparison.seconds:.0f} s in total",
        **{name: found or "not installed" for name, found in versions().items()},
    }
    listed = "".join(f"<dt>{escape(k)}</dt><dd>{escape(v)}</dd>" for k, v in facts.items())
    return (
        f"<h2>How this report was made</h2>\n<pre>{escape(command)}</pre>\n<dl>{listed}</dl>\n"
        '<p class="note">All numbers of this page are in results.json in the same folder. The '
        "paper: D. Caligiore, T. Ferrauto, D. Parisi, N. Accornero, M. Capozza, G. Baldassarre: "
        "Using motor babbling and Hebb rules for modeling the development of reaching with "
        "obstacles and grasping (2008).</p>\n"
    )
