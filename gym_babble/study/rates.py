"""Counts and rates with intervals, in JSON's types."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.study.evaluation import wilson
from gym_babble.study.tasks import REACH

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gym_babble.study.evaluation import Evaluation
    from gym_babble.study.tasks import Task

__all__ = ["OUTCOMES", "counted", "paper_tally", "share", "t_interval", "tally"]

OUTCOMES = REACH.outcomes
"""The outcomes of reaching."""

# 97.5 % points of Student's t for 1, 2, ... 9 degrees of freedom.
T_QUANTILES = (12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622)


def tally(result: Evaluation, task: Task = REACH) -> dict[str, Any]:
    """Number of cases; for each outcome and fact its count, rate and 95 % Wilson interval."""
    counts = {name: result.count(name) for name in task.outcomes}
    counts |= {name: sum(result.facts[name]) for name in task.facts}
    return counted(counts, len(result.outcomes))


def paper_tally() -> dict[str, Any]:
    """The paper's Table I in the form of `tally`."""
    assert REACH.paper is not None
    return counted(REACH.paper, sum(REACH.paper.values()))


def counted(counts: Mapping[str, int], n: int) -> dict[str, Any]:
    """The counts of `n` cases in the form of `tally`."""
    return {"cases": n, **{name: _rate(count, n) for name, count in counts.items()}}


def _rate(count: int, n: int) -> dict[str, Any]:
    low, high = wilson(count, n)
    return {"count": count, "rate": count / n, "low": low, "high": high}


def t_interval(values: Sequence[float]) -> tuple[float, float] | None:
    """95 % interval of the mean of independent values (Student's t); None for a single value."""
    n = len(values)
    if n < 2:
        return None
    mean, spread = float(np.mean(values)), float(np.std(values, ddof=1))
    half = _t_quantile(n - 1) * spread / math.sqrt(n)
    return mean - half, mean + half


def _t_quantile(freedom: int) -> float:
    """97.5 % point of Student's t: from the table, from 10 on by the Cornish-Fisher expansion."""
    if freedom <= len(T_QUANTILES):
        return T_QUANTILES[freedom - 1]
    z = 1.959964
    first = (z**3 + z) / 4
    second = (5 * z**5 + 16 * z**3 + 3 * z) / 96
    third = (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384
    return z + first / freedom + second / freedom**2 + third / freedom**3


def share(rate: float) -> str:
    """A rate in four characters: three digits without the leading zero, or 1.00."""
    return f"{rate:.3f}".removeprefix("0")[:4]
