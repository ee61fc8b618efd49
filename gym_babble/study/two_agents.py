"""Whether one agent is better than another: over their seeds, or as two fixed agents.

How often the interval of the probability of improvement holds the true one, in 1,000 simulated
studies for each row (`tests/test_coverage.py`): both agents have so many seeds, normally
distributed and half a standard deviation apart, so the true one is .64.

| seeds | coverage |
| ----- | -------- |
| 3     | .84      |
| 5     | .90      |
| 10    | .93      |
| 20    | .94      |
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.checks import shown
from gym_babble.errors import ConfigError
from gym_babble.study.statistics import (
    CONFIDENCE,
    RESAMPLES,
    RESAMPLING_SEED,
    Interval,
    scipy_stats,
    seed_scores,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["Improvement", "McNemar", "improvement", "mcnemar"]

PERMUTATIONS = 20_000
"""Rearrangements of tied seeds that are tried: all of 8 against 8, so many random ones of more."""


@dataclass(frozen=True)
class Improvement:
    """How probably a seed of one agent beats a seed of another."""

    probability: Interval
    """P(X > Y), ties counted half, with its interval."""
    p_value: float | None
    """Two-sided p-value of the Mann-Whitney U test: both agents' seeds have one distribution.

    None where an agent has one seed.
    """


@dataclass(frozen=True, kw_only=True)
class McNemar:
    """Two fixed agents on the same cases."""

    both: int
    """Cases that both solve."""
    only_first: int
    only_second: int
    neither: int
    p_value: float
    """Two-sided p-value of the exact test: only one solves a case, each as often as the other."""


def improvement(x: ArrayLike, y: ArrayLike) -> Improvement:
    """Probability that a seed of agent x scores higher than a seed of agent y, ties counted half.

    This is Agarwal et al.'s (2021) probability of improvement, the Mann-Whitney U divided by the
    number of pairs. Its interval resamples the seeds of both agents independently: equal numbers
    of seeds don't make pairs. Where all seeds of x score above all of y, the interval has no width,
    however few they are; the p-value then tells how little 3 seeds show (at least .1 with 3
    against 3, .008 with 5 against 5).

    Args:
        x: Scores of one agent, `(seeds,)` or `(seeds, cases)`; cases are averaged.
        y: Scores of the other agent.

    Raises:
        ConfigError: Scores of another shape, or not finite.
        MissingExtraError: SciPy is not installed.
    """
    first, second = seed_scores("x", x), seed_scores("y", y)
    estimate = float(_share_of_pairs(first, second))
    if min(len(first), len(second)) == 1:
        return Improvement(Interval(estimate, None, None), None)
    low, high = _ends(first, second)
    # Rounding must not put the estimate outside.
    return Improvement(
        Interval(estimate, min(low, estimate), max(high, estimate)), _p_value(first, second)
    )


def mcnemar(first: ArrayLike, second: ArrayLike) -> McNemar:
    """McNemar's exact test of two trained agents, or of two fixed ones, on the same cases.

    It is about these two agents and other cases. It says nothing about other seeds of learning: use
    `improvement` for that.

    Args:
        first: Whether the first agent solves each case, `(cases,)`.
        second: Whether the second agent solves the same case.

    Raises:
        ConfigError: Arrays of different or other shapes, or values other than 0 and 1.
        MissingExtraError: SciPy is not installed.
    """
    a, b = _solved("first", first), _solved("second", second)
    if a.shape != b.shape:
        raise ConfigError(f"first has {len(a)} cases and second {len(b)}: they must be the same")
    only_first, only_second = int(np.sum(a & ~b)), int(np.sum(b & ~a))
    differ = only_first + only_second
    p_value = scipy_stats().binomtest(only_first, differ, 0.5).pvalue if differ else 1.0
    return McNemar(
        both=int(np.sum(a & b)),
        only_first=only_first,
        only_second=only_second,
        neither=int(np.sum(~a & ~b)),
        p_value=float(p_value),
    )


def _ends(x: Floats, y: Floats) -> tuple[float, float]:
    """The bootstrap interval of the probability of improvement."""
    result = scipy_stats().bootstrap(
        (x, y),
        _share_of_pairs,
        n_resamples=RESAMPLES,
        vectorized=True,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=np.random.default_rng(RESAMPLING_SEED),
    )
    low, high = result.confidence_interval
    return float(low), float(high)


def _p_value(x: Floats, y: Floats) -> float:
    """Of the Mann-Whitney U test: exact, with ties from rearrangements of the seeds."""
    stats = scipy_stats()
    method = "exact"
    if len(np.unique([*x, *y])) < len(x) + len(y):
        rng = np.random.default_rng(RESAMPLING_SEED)
        method = stats.PermutationMethod(n_resamples=PERMUTATIONS, batch=PERMUTATIONS, rng=rng)
    return float(stats.mannwhitneyu(x, y, method=method).pvalue)


def _share_of_pairs(x: NDArray[Any], y: NDArray[Any], axis: int = -1) -> Any:
    """Share of pairs in which x is greater, ties counted half; `axis` is the last one."""
    assert axis == -1
    signs = np.sign(x[..., :, None] - y[..., None, :])
    return (1 + signs.mean(axis=(-2, -1))) / 2


def _solved(name: str, values: ArrayLike) -> NDArray[np.bool_]:
    array = np.asarray(values)
    if array.ndim != 1 or not array.size:
        raise ConfigError(f"{name} has shape {array.shape}, expected (cases,) with 1 case or more")
    if not np.isin(array, (0, 1)).all():
        wrong = next(value for value in array.tolist() if value not in {0, 1})
        raise ConfigError(f"{name} has {shown(wrong)}, expected True or False for each case")
    return array.astype(bool)
