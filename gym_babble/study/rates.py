"""Counts and rates with intervals, in JSON's types.

The cases of one seed give a rate and its Wilson interval. Several seeds give a mean and a range:
cases of different seeds are not pooled, because agents of different seeds differ more than that.
"""

from __future__ import annotations

from statistics import fmean
from typing import TYPE_CHECKING, Any

from gym_babble.study.outcomes import wilson
from gym_babble.study.tasks import REACH

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from gym_babble.study.outcomes import Evaluation
    from gym_babble.study.tasks import Task

__all__ = [
    "OUTCOMES",
    "counted",
    "counts",
    "over_seeds",
    "paper_tally",
    "share",
    "sizes_of",
    "spread",
    "tally",
]

OUTCOMES = REACH.outcomes
"""The outcomes of reaching."""


def counts(result: Evaluation, names: Collection[str]) -> dict[str, int]:
    """Number of cases, and how many have each outcome or fact."""
    return {"cases": len(result), **{name: result.count(name) for name in names}}


def counted(counts: Mapping[str, int]) -> dict[str, Any]:
    """`counts` with rates: for each outcome and fact its count, rate and 95 % Wilson interval."""
    n = counts["cases"]
    rates = {name: _rate(count, n) for name, count in counts.items() if name != "cases"}
    return {"cases": n, **rates}


def tally(result: Evaluation, task: Task = REACH) -> dict[str, Any]:
    """Number of cases; for each outcome and fact its count, rate and 95 % Wilson interval.

    Where objects have several sizes, `by_size` has the same for each size.
    """
    sizes = result.by_size()
    split = {size: counted(counts(part, task.rates)) for size, part in sizes.items()}
    return {**counted(counts(result, task.rates)), **({"by_size": split} if split else {})}


def paper_tally() -> dict[str, Any]:
    """The paper's Table I in the form of `tally`."""
    assert REACH.paper is not None
    return counted({"cases": sum(REACH.paper.values()), **REACH.paper})


def over_seeds(tallies: Sequence[Mapping[str, Any]], names: Collection[str]) -> dict[str, Any]:
    """Number of seeds; for each outcome and fact the mean of the seeds' rates, and their range."""
    rates = {name: spread([one[name]["rate"] for one in tallies]) for name in names}
    return {"seeds": len(tallies), **rates}


def spread(values: Sequence[float]) -> dict[str, float]:
    """Mean of the seeds' values, smallest and largest."""
    return {"mean": fmean(values), "min": min(values), "max": max(values)}


def sizes_of(tallies: Sequence[Mapping[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    """For each size of the objects its tallies, one for each seed that has such cases."""
    sizes: dict[str, list[dict[str, Any]]] = {}
    for one in tallies:
        for size, part in one.get("by_size", {}).items():
            sizes.setdefault(size, []).append(part)
    return sizes


def _rate(count: int, n: int) -> dict[str, Any]:
    low, high = wilson(count, n)
    return {"count": count, "rate": count / n, "low": low, "high": high}


def share(rate: float) -> str:
    """A rate in four characters: three digits without the leading zero, or 1.00."""
    return f"{rate:.3f}".removeprefix("0")[:4]
