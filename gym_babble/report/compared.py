"""Agents beside each other: probability of improvement, performance profiles, McNemar's test."""

from __future__ import annotations

from dataclasses import asdict, replace
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.study.statistics import Interval, profile
from gym_babble.study.two_agents import improvement, mcnemar

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.report.data import AgentRuns

__all__ = ["improvement_numbers", "mcnemar_numbers", "profile_numbers"]

THRESHOLDS = 101
"""Success rates at which a profile is computed, from 0 to 1."""


def profile_numbers(agents: Sequence[AgentRuns]) -> dict[str, dict[str, Any]]:
    """The share of each agent's seeds that succeed more often than each rate."""
    rates = np.linspace(0.0, 1.0, THRESHOLDS).round(6)
    return {agent.spec.label: asdict(profile(agent.happened("success"), rates)) for agent in agents}


def improvement_numbers(agents: Sequence[AgentRuns]) -> dict[str, dict[str, Any]]:
    """For each agent X and each other Y: the probability that a seed of X succeeds more often.

    It is computed once for each two agents, and mirrored for the other order.
    """
    found: dict[str, dict[str, Any]] = {agent.spec.label: {} for agent in agents}
    for x, y in combinations(agents, 2):
        better = improvement(x.happened("success"), y.happened("success"))
        found[x.spec.label][y.spec.label] = asdict(better)
        mirrored = replace(better, probability=_mirrored(better.probability))
        found[y.spec.label][x.spec.label] = asdict(mirrored)
    return found


def _mirrored(of: Interval) -> Interval:
    """The interval of the opposite event's probability."""
    if of.low is None or of.high is None:
        return Interval(1 - of.estimate, None, None)
    return Interval(1 - of.estimate, 1 - of.high, 1 - of.low)


def mcnemar_numbers(agents: Sequence[AgentRuns]) -> list[dict[str, Any]]:
    """McNemar's test of the first runs of each two agents, on the same cases."""
    found = []
    for x, y in combinations(agents, 2):
        test = mcnemar(x.happened("success")[0], y.happened("success")[0])
        pair = {"x": x.spec.label, "x_seed": x.seeds[0], "y": y.spec.label, "y_seed": y.seeds[0]}
        found.append({**pair, **asdict(test)})
    return found
