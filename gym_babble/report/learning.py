"""Learning curves, and how much learning it takes to reach a rate."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.report.data import AXES
from gym_babble.study.efficiency import LEVELS, Curve, budget, ratio
from gym_babble.study.statistics import interval

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.report.data import AgentRuns
    from gym_babble.study.efficiency import Budget

__all__ = ["budget_numbers", "curve_numbers", "ratio_numbers"]


def curve_numbers(agent: AgentRuns, axis: str) -> dict[str, Any]:
    """Success while learning: IQM and interval over the seeds, and each run's own curve.

    Runs have their checkpoints at slightly different costs. Between two checkpoints a run's success
    is taken as a straight line over the logarithm of the cost.
    """
    runs = agent.curves(axis)
    points = [
        {"cost": cost, **asdict(interval([_at(cost, *run) for run in runs]))}
        for cost in _grid([costs for costs, _ in runs])
    ]
    each = [
        {"seed": seed, "cost": costs, "success": success}
        for seed, (costs, success) in zip(agent.seeds, runs, strict=True)
    ]
    return {"points": points, "runs": each}


def budget_numbers(agent: AgentRuns, axis: str) -> list[dict[str, Any]]:
    """What the agent has used when it first reached each level of success."""
    return [{**asdict(one), "reached": one.reached} for one in _budgets(agent, axis)]


def ratio_numbers(learners: Sequence[AgentRuns]) -> dict[str, dict[str, list[dict[str, Any]]]]:
    """How many times the cost of the first learner each of the others needs, by axis."""
    found: dict[str, dict[str, list[dict[str, Any]]]] = {}
    for other in learners[1:]:
        found[other.spec.label] = {}
        for axis in AXES:
            pairs = zip(_budgets(other, axis), _budgets(learners[0], axis), strict=True)
            ratios = [ratio(one, first) for one, first in pairs]
            found[other.spec.label][axis] = [{**asdict(one), "text": str(one)} for one in ratios]
    return found


def _budgets(agent: AgentRuns, axis: str) -> list[Budget]:
    curves = [Curve(np.array(costs), np.array(rates)) for costs, rates in agent.curves(axis)]
    return [budget(curves, level) for level in LEVELS]


def _grid(costs: Sequence[Sequence[float]]) -> list[float]:
    """Costs of the run with the fewest checkpoints, within what all runs have."""
    first, last = max(one[0] for one in costs), min(one[-1] for one in costs)
    inner = [cost for cost in min(costs, key=len) if first < cost < last]
    return sorted({first, *inner, last}) if first <= last else []


def _at(cost: float, costs: Sequence[float], success: Sequence[float]) -> float:
    return float(np.interp(np.log(cost), np.log(costs), success))
