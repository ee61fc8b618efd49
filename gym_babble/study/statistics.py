"""Statistics of one agent over the seeds of its learning.

A seed of learning is one independent run, so a study has as many observations as seeds. The cases
of one run share its agent: `Evaluation.interval` is an interval over episodes of one trained agent,
and says nothing about another seed.

Scores are success rates or other numbers, in one of two shapes:

- `(seeds,)`: one score for each seed.
- `(seeds, cases)`: the outcome of each case for each seed, where all seeds were tested on the same
  cases. The score of a seed is the mean over its cases.

All intervals are 95 % percentile intervals of the bootstrap, as in Agarwal et al. (2021), "Deep
reinforcement learning at the edge of the statistical precipice", and in its library `rliable`.
Resampling has a fixed seed and sorts the scores first, so the same scores give the same bits in any
order of the seeds. The optimality gap is left out: for rates it is 1 minus the mean.

How often the interval of the IQM holds the true one, in 1,000 simulated studies for each row
(`tests/test_coverage.py`): for seeds that are normally distributed; seeds near 1 (Beta(19, 1),
tested on 1,000 cases); seeds of which a fifth fails; and, resampling seeds and cases, for 100
cases of different difficulty. The standard error of these figures is .01.

| seeds | normal | near 1 | a fifth fails | seeds and cases |
| ----- | ------ | ------ | ------------- | --------------- |
| 3     | .76    | .74    | .75           | .87             |
| 5     | .88    | .90    | .91           | .95             |
| 10    | .95    | .93    | .92           | .96             |
| 20    | .94    | .96    | .94           | .96             |
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.checks import numbers
from gym_babble.errors import ConfigError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]
    Statistic = Callable[..., Any]
    """Takes an array and the keyword `axis`, as `iqm` and `numpy.mean` do."""

__all__ = [
    "CONFIDENCE",
    "RESAMPLES",
    "Interval",
    "Profile",
    "Summary",
    "few_seeds",
    "interval",
    "iqm",
    "profile",
    "seed_scores",
    "summary",
]

CONFIDENCE = 0.95
"""Nominal coverage of every interval."""
RESAMPLES = 10_000
"""Resamples of each bootstrap."""
RESAMPLING_SEED = 0
"""Seed of every bootstrap, so that a report repeats its bits."""
FEWEST_SEEDS = 5
"""Below this many seeds a report warns."""


@dataclass(frozen=True)
class Interval:
    """An estimate and its 95 % interval."""

    estimate: float
    low: float | None
    """Lower end; None for one seed, which has no interval."""
    high: float | None
    """Upper end; None for one seed."""


@dataclass(frozen=True, kw_only=True)
class Summary:
    """What the seeds of one agent have in common, and how far they lie apart."""

    seeds: int
    """Number of seeds."""
    iqm: Interval
    """Interquartile mean, with its interval."""
    mean: float
    median: float
    worst: float
    """Score of the worst seed."""
    best: float
    """Score of the best seed."""


@dataclass(frozen=True)
class Profile:
    """A performance profile: the share of seeds that score above each threshold."""

    thresholds: tuple[float, ...]
    shares: tuple[float, ...]
    low: tuple[float, ...]
    """Lower ends of the band; each threshold has its own 95 % interval."""
    high: tuple[float, ...]
    """Upper ends of the band."""


def iqm(scores: ArrayLike, axis: int = -1) -> Any:
    """Interquartile mean: the mean of the middle half of the scores (Agarwal et al. 2021).

    A quarter of the scores, rounded down, is cut at each end. So all of 3 seeds count, the middle 3
    of 5, and the middle 6 of 10.

    Args:
        scores: Scores.
        axis: Axis of the seeds.

    Raises:
        MissingExtraError: SciPy is not installed.
    """
    return scipy_stats().trim_mean(scores, 0.25, axis=axis)


def interval(scores: ArrayLike, statistic: Statistic = iqm) -> Interval:
    """A statistic of the seeds' scores, with its 95 % bootstrap interval.

    With one score for each seed, seeds are resampled: the interval is about other seeds of
    learning, tested on these very cases. With an outcome for each case, seeds and cases are
    resampled, both with replacement and independently of each other: the interval is about other
    seeds and other cases. This is the pigeonhole bootstrap of Owen (2007), and tests compare its
    variance with his formula. It is conservative: it counts the noise of single outcomes up to
    three times.

    Seeds that all have the same score give an interval without width, however few they are.

    Args:
        scores: `(seeds,)` or `(seeds, cases)`.
        statistic: Function of the seeds' scores; it takes an array and `axis`.

    Raises:
        ConfigError: Scores of another shape, or not finite.
        MissingExtraError: SciPy is not installed.
    """
    checked = _checked("scores", scores)
    estimate = float(statistic(np.sort(_of_seeds(checked)), axis=-1))
    if len(checked) == 1:
        return Interval(estimate, None, None)
    resample = _resample_seeds if checked.ndim == 1 else _resample_both
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(resample(checked, statistic), [tail, 1 - tail]).tolist()
    # Rounding must not put the estimate outside, which could happen where all resamples agree.
    return Interval(estimate, min(low, estimate), max(high, estimate))


def summary(scores: ArrayLike) -> Summary:
    """IQM with interval, mean, median, worst and best seed.

    Args:
        scores: `(seeds,)` or `(seeds, cases)`, as for `interval`.

    Raises:
        ConfigError: Scores of another shape, or not finite.
        MissingExtraError: SciPy is not installed.
    """
    each = seed_scores("scores", scores)
    return Summary(
        seeds=len(each),
        iqm=interval(scores),
        mean=float(each.mean()),
        median=float(np.median(each)),
        worst=float(each[0]),
        best=float(each[-1]),
    )


def profile(scores: ArrayLike, thresholds: ArrayLike) -> Profile:
    """The share of seeds that score above each threshold (Agarwal et al. 2021).

    The band is the percentile interval of the bootstrap over seeds. It needs no resampling: the
    number of seeds above a threshold in a resample is binomial.

    Args:
        scores: `(seeds,)` or `(seeds, cases)`; cases are averaged, not resampled.
        thresholds: Thresholds in any order.

    Raises:
        ConfigError: Scores or thresholds of another shape, or not finite.
        MissingExtraError: SciPy is not installed.
    """
    each = seed_scores("scores", scores)
    levels = numbers("thresholds", thresholds)
    if levels.ndim != 1:
        raise ConfigError(f"thresholds has shape {levels.shape}, expected (thresholds,)")
    shares = np.mean(each > levels[:, None], axis=1)
    tail = (1 - CONFIDENCE) / 2
    quantile = scipy_stats().binom.ppf
    low, high = (quantile(p, len(each), shares) / len(each) for p in (tail, 1 - tail))
    return Profile(*(tuple(values.tolist()) for values in (levels, shares, low, high)))


def few_seeds(seeds: int) -> str | None:
    """A warning for a study with fewer than 5 seeds; None from 5 on."""
    if seeds >= FEWEST_SEEDS:
        return None
    if seeds == 1:
        return "Only 1 seed: it has no interval, and another seed may give another result."
    return (
        f"Only {seeds} seeds: a 95 % interval over so few holds the true value less often than in"
        " 95 % of studies (3 seeds: in about 75 % of simulated ones). Use 5 seeds or more."
    )


def seed_scores(name: str, scores: ArrayLike) -> Floats:
    """The score of each seed, sorted; cases are averaged.

    Raises:
        ConfigError: Scores of another shape than `(seeds,)` or `(seeds, cases)`, or not finite.
    """
    return np.sort(_of_seeds(_checked(name, scores)))


def scipy_stats() -> Any:
    """The module `scipy.stats`, which is not loaded with the package.

    Raises:
        MissingExtraError: SciPy is not installed.
    """
    try:
        from scipy import stats
    except ImportError as error:
        raise MissingExtraError("scipy", "study") from error
    return stats


def _checked(name: str, scores: ArrayLike) -> Floats:
    """Scores as an array of `(seeds,)` or `(seeds, cases)`."""
    array = np.asarray(scores)
    checked = numbers(name, array.astype(float) if array.dtype == bool else array)
    if checked.ndim not in {1, 2} or not checked.size:
        raise ConfigError(
            f"{name} has shape {checked.shape}, expected (seeds,) or (seeds, cases), none of them 0"
        )
    return checked


def _of_seeds(scores: Floats) -> Floats:
    return scores if scores.ndim == 1 else scores.mean(axis=1)


def _resample_seeds(scores: Floats, statistic: Statistic) -> Floats:
    """The statistic of each resample of the seeds."""
    distribution: Floats = (
        scipy_stats()
        .bootstrap(
            (np.sort(scores),),
            statistic,
            n_resamples=RESAMPLES,
            vectorized=True,
            method="percentile",
            rng=np.random.default_rng(RESAMPLING_SEED),
        )
        .bootstrap_distribution
    )
    return distribution


def _resample_both(scores: Floats, statistic: Statistic) -> Floats:
    """The statistic of each resample of seeds and cases."""
    rows = scores[np.lexsort(scores.T)]
    # Cases with the same outcomes for all seeds count together: far fewer columns, same bootstrap.
    kinds, counts = np.unique(rows, axis=1, return_counts=True)
    rng = np.random.default_rng(RESAMPLING_SEED)
    seeds, cases = rows.shape
    chosen = rng.integers(seeds, size=(RESAMPLES, seeds))
    drawn = rng.multinomial(cases, counts / cases, size=RESAMPLES)
    resampled = np.take_along_axis(drawn @ kinds.T / cases, chosen, axis=1)
    return np.asarray(statistic(resampled, axis=-1))
