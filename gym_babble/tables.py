"""Rates with intervals: as JSON, and in tables for the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.evaluation import wilson

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from gym_babble.evaluation import Evaluation

__all__ = ["OUTCOMES", "PAPER", "plain_table", "rate_cells", "share", "t_interval", "tally"]

OUTCOMES = ("success", "collision", "joint_limit", "timeout")
"""How an episode of reaching can end; each has exactly one."""

PAPER = {"success": 670, "collision": 228, "joint_limit": 102, "timeout": 0}
"""Table I of the paper: counts of 1,000 tests. Of its babbled movements about .20 were legal."""

# 97.5 % points of Student's t for 1, 2, ... 9 degrees of freedom.
T_QUANTILES = (12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622)


def tally(result: Evaluation) -> dict[str, Any]:
    """Number of cases, and for each outcome count, rate and 95 % Wilson interval."""
    n = len(result.outcomes)
    return {"cases": n, **{name: _counted(result.count(name), n) for name in OUTCOMES}}


def paper_tally() -> dict[str, Any]:
    """The paper's Table I in the form of `tally`."""
    n = sum(PAPER.values())
    return {"cases": n, **{name: _counted(count, n) for name, count in PAPER.items()}}


def _counted(count: int, n: int) -> dict[str, Any]:
    low, high = wilson(count, n)
    return {"count": count, "rate": count / n, "low": low, "high": high}


def t_interval(values: Sequence[float]) -> tuple[float, float] | None:
    """95 % interval of the mean over independent values (Student's t); None for a single one."""
    n = len(values)
    if n < 2:
        return None
    mean, spread = float(np.mean(values)), float(np.std(values, ddof=1))
    half = _t_quantile(n - 1) * spread / math.sqrt(n)
    return mean - half, mean + half


def _t_quantile(freedom: int) -> float:
    """97.5 % point of Student's t: tabled, from 10 on by the expansion of Cornish and Fisher."""
    if freedom <= len(T_QUANTILES):
        return T_QUANTILES[freedom - 1]
    z = 1.959964
    first = (z**3 + z) / 4
    second = (5 * z**5 + 16 * z**3 + 3 * z) / 96
    third = (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384
    return z + first / freedom + second / freedom**2 + third / freedom**3


def share(rate: float) -> str:
    """A rate in four characters: three digits without a leading zero, or 1.00."""
    return f"{rate:.3f}".removeprefix("0")[:4]


def rate_cells(rates: dict[str, Any]) -> list[str]:
    """For each outcome of a `tally` a cell with the rate, and under it the interval."""
    return [
        f"{share(rates[name]['rate'])}\n[dim]{share(rates[name]['low'])}–{share(rates[name]['high'])}[/]"
        for name in OUTCOMES
    ]


def plain_table(
    title: str | None, columns: Sequence[str], *, left: int = 1, padding: int = 1
) -> Table:
    """An empty table without lines; the first `left` columns hold text, the others numbers."""
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
