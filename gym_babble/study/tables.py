"""Tables of rates for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.study.rates import share
from gym_babble.study.tasks import REACH

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rich.table import Table

    from gym_babble.study.tasks import Task

__all__ = ["format_interval", "plain_table", "rate_cells", "rate_heads", "rates_table"]


def rate_heads(task: Task = REACH, between: str = " ") -> list[str]:
    """Headers of the columns of `rate_cells`, with `between` separating words."""
    touches = ["any touch\n[dim]of palm[/]"] if task.facts else []
    return [*(name.replace("_", between) for name in task.outcomes), *touches]


def rate_cells(rates: dict[str, Any], task: Task = REACH) -> list[str]:
    """Cells of a `tally`: rate and interval for each outcome, and one cell for the facts."""
    cells = [
        f"{share(rates[name]['rate'])}\n{format_interval(rates[name])}" for name in task.outcomes
    ]
    if task.facts:
        first, second = (share(rates[name]["rate"]) for name in task.facts)
        cells.append(f"{first}\n[dim]{second}[/]")
    return cells


def format_interval(rate: Mapping[str, Any]) -> str:
    """The interval of a rate, dimmed."""
    return f"[dim]{share(rate['low'])}–{share(rate['high'])}[/]"


def plain_table(
    title: str | None, columns: Sequence[str], *, left: int = 1, padding: int = 1
) -> Table:
    """An empty table without lines; the first `left` columns are text, the others numbers."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(
        title=title,
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
