"""Learning curves, and how much learning it takes to reach a rate."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from gym_babble.study.efficiency import LEVELS, Curve, budget, ratio
from gym_babble.study.statistics import interval

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from gym_babble.study.efficiency import Budget

__all__ = ["Runs", "budget_numbers", "curve_numbers", "ratio_numbers"]

Runs: TypeAlias = "Sequence[tuple[Sequence[float], Sequence[float]]]"
"""Cost and success at the checkpoints of each run, along one axis."""


def curve_numbers(runs: Runs, seeds: Sequence[int | str]) -> dict[str, Any]:
    """Success while learning: IQM and interval over the seeds, and each run's own curve.

    Runs have their checkpoints at slightly different costs. Between two checkpoints a run's success
    is taken as a straight line over the logarithm of the cost.
    """
    points = [
        {"cost": cost, **asdict(interval([_at(cost, *run) for run in runs]))}
        for cost in _grid([costs for costs, _ in runs])
    ]
    each = [
        {"seed": seed, "cost": costs, "success": success}
        for seed, (costs, success) in zip(seeds, runs, strict=True)
    ]
    return {"points": points, "runs": each}


def budget_numbers(runs: Runs) -> list[dict[str, Any]]:
    """What the runs have used when they first reached each level of success."""
    return [{**asdict(one), "reached": one.reached} for one in _budgets(runs)]


def ratio_numbers(
    learners: Mapping[str, Runs], references: Collection[str]
) -> dict[str, dict[str, list[dict[str, Any]]]]:
    """How many times the cost of each reference each other learner needs, by label."""
    budgets = {label: _budgets(runs) for label, runs in learners.items()}
    return {
        one: {other: _ratios(budgets[other], budgets[one]) for other in budgets if other != one}
        for one in references
    }


def _ratios(budgets: Sequence[Budget], reference: Sequence[Budget]) -> list[dict[str, Any]]:
    ratios = [ratio(*pair) for pair in zip(budgets, reference, strict=True)]
    return [{**asdict(one), "text": str(one)} for one in ratios]


def _budgets(runs: Runs) -> list[Budget]:
    curves = [Curve(np.array(costs), np.array(rates)) for costs, rates in runs]
    return [budget(curves, level) for level in LEVELS]


def _grid(costs: Sequence[Sequence[float]]) -> list[float]:
    """Costs of the run with the fewest checkpoints, within what all runs have."""
    first, last = max(one[0] for one in costs), min(one[-1] for one in costs)
    inner = [cost for cost in min(costs, key=len) if first < cost < last]
    return sorted({first, *inner, last}) if first <= last else []


def _at(cost: float, costs: Sequence[float], success: Sequence[float]) -> float:
    return float(np.interp(np.log(cost), np.log(costs), success))
