"""The section of a report with the rates of all agents."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from gym_babble.report.html import named, rates_row
from gym_babble.report.words import WORDS
from gym_babble.study.comparison import StoredResult
from gym_babble.study.rates import paper_tally, share
from gym_babble.study.tables import INTERVALS

if TYPE_CHECKING:
    from gym_babble.study.comparison import Comparison, Result

__all__ = ["rates_section"]


def rates_section(comparison: Comparison) -> str:
    """The table of rates, with explanations."""
    task, settings = comparison.task, comparison.settings
    names = [*task.outcomes, *("touch" if name == "reach" else "of palm" for name in task.facts)]
    names = [
        "agent",
        "",
        *(name.replace("_", " ") for name in names),
        task.trials,
        "steps",
        "clock",
    ]
    head = "".join(f"<th>{name}</th>" for name in names)
    rows = ""
    if task.paper is not None:
        cells = ["20,000<small>legal ≈ .20</small>", "", ""]
        paper = rates_row(named("the paper", "Table I"), paper_tally(), task, cells)
        rows = paper.replace("<tr>", "<tr class=paper>")
    rows += "".join(_result_rows(result) for result in comparison.results)
    notes = "".join(
        f'<p class="note">{escape(note[0].upper() + note[1:])}.</p>' for note in comparison.notes
    )
    key = "".join(f'<i class="{name}"></i>{name.replace("_", " ")}' for name in task.outcomes)
    words = WORDS[task.name]
    stored = any(isinstance(result, StoredResult) for result in comparison.results)
    elsewhere = ", for a stored study on the machine that ran it" if stored else ""
    return (
        f"<h2>{'Table I' if task.paper else 'Success'}</h2>\n<p>{settings.cases:,} {words.cases}"
        f"{f', for each of {settings.seeds} seeds' if settings.seeds > 1 else ''}. {INTERVALS} "
        f"{words.rates}"
        f'</p>\n<div class="scroll"><table><tr>{head}</tr>\n{rows}</table></div>\n'
        f'<p class="note key">{key}</p>\n'
        f'<p class="note">{words.learning} Clock: seconds of '
        f"learning on this machine{elsewhere}; means of several seeds.</p>\n"
        f"{notes}"
    )


def _result_rows(result: Result) -> str:
    """The rows of a contender; only the first tells what it has learnt from."""
    task, cells = result.task, ["", "", ""]
    if result.mean("trials"):
        trials = f"{result.mean('trials'):,.0f}"
        if result.accepted_rate is not None:
            accepted = result.mean("accepted")
            trials = f"{accepted:,.0f}<small>{task.accepted} {share(result.accepted_rate)}</small>"
        steps = f"{result.mean('control_steps') / 1e6:.1f} M"
        cells = [trials, steps, f"{result.mean('seconds'):.0f} s"]
    first, *rest = result.rows
    name = named(result.contender.title, result.contender.detail)
    rows = [rates_row(name, first.rates, task, cells)]
    for row in rest:
        part = rates_row(escape(row.title), row.rates, task, ["", "", ""])
        rows.append(part.replace("<tr>", "<tr class=part>"))
    return "".join(rows)
