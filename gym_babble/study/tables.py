"""Tables of rates for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from gym_babble.study.rates import over_seeds, share, sizes_of
from gym_babble.study.tasks import REACH

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rich.table import Table
    from rich.text import Text

    from gym_babble.study.tasks import Task

__all__ = [
    "INTERVALS",
    "RateRow",
    "plain_table",
    "rate_cell",
    "rate_cells",
    "rate_heads",
    "rate_rows",
    "rates_table",
    "stacked",
]

INTERVALS = (
    "Below a rate of one seed: its 95 % Wilson interval over the cases. Below a mean of seeds: "
    "smallest and largest seed."
)
"""Explains the second line of a rate."""


class RateRow(NamedTuple):
    """The rates of a row, and what they are of."""

    title: str
    """A size or a seed; empty for all together."""
    rates: dict[str, dict[str, float]]
    """For each outcome and fact `rate`, `low` and `high`."""


def rate_rows(
    tallies: Sequence[Mapping[str, Any]], seeds: Sequence[int], task: Task = REACH
) -> list[RateRow]:
    """The rows of tests: all cases, then each size of the objects, then each seed of several."""
    rows = [RateRow("", _rates(tallies, task))]
    rows += [RateRow(size, _rates(of_size, task)) for size, of_size in sizes_of(tallies).items()]
    if len(tallies) > 1:
        each = zip(seeds, tallies, strict=True)
        rows += [RateRow(f"seed {seed}", _rates([one], task)) for seed, one in each]
    return rows


def _rates(tallies: Sequence[Mapping[str, Any]], task: Task) -> dict[str, dict[str, float]]:
    """Rates and intervals of one seed, or means and ranges of several."""
    if len(tallies) == 1:
        return {name: tallies[0][name] for name in task.rates}
    means = over_seeds(tallies, task.rates)
    return {
        name: {"rate": means[name]["mean"], "low": means[name]["min"], "high": means[name]["max"]}
        for name in task.rates
    }


def rate_heads(task: Task = REACH, between: str = " ") -> list[str | Text]:
    """Headers of the columns of `rate_cells`, with `between` separating words."""
    touches = [stacked("any touch", "of palm")] if task.facts else []
    return [*(name.replace("_", between) for name in task.outcomes), *touches]


def rate_cells(rates: Mapping[str, Any], task: Task = REACH) -> list[Text]:
    """Cells of a row: rate and interval for each outcome, and one cell for the facts."""
    cells = [rate_cell(rates[name]) for name in task.outcomes]
    if task.facts:
        first, second = (share(rates[name]["rate"]) for name in task.facts)
        cells.append(stacked(first, second))
    return cells


def rate_cell(rate: Mapping[str, Any]) -> Text:
    """A rate, and its interval below."""
    return stacked(share(rate["rate"]), f"{share(rate['low'])}–{share(rate['high'])}")


def stacked(first: str, second: str, style: str = "") -> Text:
    """Two lines, the second dimmed. They are shown as they are, square brackets too."""
    from rich.text import Text

    return Text.assemble((first, style), "\n", (second, "dim"))


def plain_table(
    title: str | None, columns: Sequence[str | Text], *, left: int = 1, padding: int = 1
) -> Table:
    """An empty table without lines; the first `left` columns are text, the others numbers."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    table = Table(
        title=None if title is None else Text(title),
        title_justify="left",
        title_style="bold",
        caption_justify="left",
        box=SIMPLE_HEAD,
        show_edge=False,
        pad_edge=False,
        padding=(0, padding),
    )
    for i, column in enumerate(columns):
        table.add_column(column, justify="left" if i < left else "right", no_wrap=i == 0)
    return table


def rates_table(title: str, *more: str, task: Task = REACH) -> Table:
    """An empty table for `rate_cells` and further columns."""
    return plain_table(title, ["", *rate_heads(task), *more])
