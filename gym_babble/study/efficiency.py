"""Sample efficiency: the budget that an agent needs to reach a level of success.

A study tests an agent at checkpoints. So a seed's budget is known between two of them: it needs
more than the last checkpoint before it first reached the level, and at most the checkpoint at which
it did. A seed that never reached the level needs more than its last checkpoint. Nothing is
interpolated, and a level that was not reached has no number, only a bound.

The medians over seeds, and their ratios, inherit both bounds. Their 95 % intervals come from a
bootstrap over seeds, the lower end from the lower bounds and the upper end from the upper ones. So
they cover both the seeds and the distance of the checkpoints.

How often these intervals hold the true median and the true ratio, in 1,000 simulated studies for
each row (`tests/test_coverage.py`): seeds that need a log-normal number of steps (a standard
deviation is a factor of e), checkpoints at 1, 2 and 5 times powers of ten, a budget that a fifth of
the slower agent's seeds exceed, and a ratio of 8.

| seeds | median | ratio |
| ----- | ------ | ----- |
| 3     | .90    | .98   |
| 5     | .98    | 1.00  |
| 10    | .99    | 1.00  |
| 20    | .98    | 1.00  |
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gym_babble.checks import check_number, numbers
from gym_babble.errors import ConfigError
from gym_babble.study.statistics import CONFIDENCE, RESAMPLES, RESAMPLING_SEED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["LEVELS", "Budget", "Crossing", "Curve", "Ratio", "budget", "crossing", "ratio"]

LEVELS = (0.5, 0.67, 0.8, 0.9, 0.95)
"""Levels of success that a report has; .67 is the paper's result in reaching."""


@dataclass(frozen=True, eq=False)
class Curve:
    """The learning curve of one seed.

    Raises:
        ConfigError: Arrays of different or other shapes, no checkpoint, control steps that are
            negative or do not increase, or a success rate outside of [0, 1].
    """

    control_steps: Floats
    """Control steps learnt from at each checkpoint, `(checkpoints,)`."""
    success: Floats
    """Success rate at each checkpoint, `(checkpoints,)`."""

    def __post_init__(self) -> None:
        steps = numbers("control_steps", self.control_steps)
        success = numbers("success", self.success)
        if steps.ndim != 1 or not steps.size or steps.shape != success.shape:
            raise ConfigError(
                f"control_steps has shape {steps.shape} and success {success.shape}, expected"
                " (checkpoints,) for both, with 1 checkpoint or more"
            )
        check_number("control_steps[0]", steps[0], 0, np.inf, "control steps")
        for k in np.flatnonzero(np.diff(steps) <= 0)[:1] + 1:
            raise ConfigError(
                f"control_steps[{k}] = {steps[k]:g} is not greater than the one before,"
                f" {steps[k - 1]:g}"
            )
        for k in np.flatnonzero((success < 0) | (success > 1))[:1]:
            raise ConfigError(f"success[{k}] = {success[k]:g} is not a rate in [0, 1]")
        object.__setattr__(self, "control_steps", steps)
        object.__setattr__(self, "success", success)


@dataclass(frozen=True)
class Crossing:
    """When one seed first reached a level of success."""

    after: float
    """It took more than this [control steps]; 0 if the first checkpoint reached the level."""
    by: float | None
    """It took at most this [control steps]; None if no checkpoint reached the level."""


@dataclass(frozen=True, kw_only=True)
class Budget:
    """The control steps that an agent needs to reach a level of success."""

    level: float
    """Success rate."""
    seeds: tuple[Crossing, ...]
    """Each seed, in the order of the curves."""
    after: float
    """The median seed needs more than this [control steps]."""
    by: float | None
    """The median seed needs at most this; None if it did not reach the level."""
    low: float | None
    """Lower end of the 95 % interval of the median; None for one seed."""
    high: float | None
    """Upper end; None if it lies beyond what was tested, and for one seed."""

    @property
    def reached(self) -> int:
        """Number of seeds that reached the level."""
        return sum(seed.by is not None for seed in self.seeds)

    def __str__(self) -> str:
        if self.by is None:
            return f"more than {self.after:,.0f}"
        return _with_interval(self.by, self.low, self.high, ",.0f")


@dataclass(frozen=True, kw_only=True)
class Ratio:
    """How many times the budget of another agent an agent needs."""

    value: float | None
    """Ratio of the median budgets; None if an agent did not reach the level, or needs nothing."""
    least: float
    """Smallest ratio of medians that fits the checkpoints; 0 if there is no bound."""
    most: float | None
    """Greatest ratio of medians that fits the checkpoints; None if there is no bound."""
    low: float | None
    """Lower end of the 95 % interval, 0 if there is no bound; None if an agent has one seed."""
    high: float | None
    """Upper end; None if there is no bound, or if an agent has one seed."""

    def __str__(self) -> str:
        if self.value is not None:
            return _with_interval(self.value, self.low, self.high, ".3g")
        low = self.least if self.low is None else self.low
        high = self.most if self.low is None else self.high
        if low > 0 and high is not None:
            return f"between {low:.3g} and {high:.3g}"
        if low > 0:
            return f"at least {low:.3g}"
        return "unknown" if high is None else f"at most {high:.3g}"


def crossing(curve: Curve, level: float) -> Crossing:
    """The budget at which a seed first reached a level; later it may fall below again.

    Args:
        curve: Learning curve of the seed.
        level: Success rate in (0, 1].

    Raises:
        ConfigError: A level out of bounds.
    """
    level = _check_level(level)
    reached = np.flatnonzero(curve.success >= level)
    if not reached.size:
        return Crossing(float(curve.control_steps[-1]), None)
    first = int(reached[0])
    by = float(curve.control_steps[first])
    return Crossing(float(curve.control_steps[first - 1]) if first else 0.0, by)


def budget(curves: Sequence[Curve], level: float) -> Budget:
    """The budget that an agent's seeds need to reach a level: each, and their median.

    Args:
        curves: Learning curve of each seed.
        level: Success rate in (0, 1].

    Raises:
        ConfigError: No curve, or a level out of bounds.
    """
    if not curves:
        raise ConfigError("curves is empty, expected the curve of one seed or more")
    seeds = tuple(crossing(curve, level) for curve in curves)
    least, most = (float(np.median(bounds)) for bounds in _bounds(seeds))
    low = high = None
    if len(seeds) > 1:
        resampled = _resampled_medians(seeds, np.random.default_rng(RESAMPLING_SEED))
        low, high = _ends(*resampled, least, most)
    return Budget(
        level=float(level), seeds=seeds, after=least, by=_finite(most), low=low, high=high
    )


def ratio(budget: Budget, other: Budget) -> Ratio:
    """How many times the budget of the other agent an agent needs, with its interval.

    The seeds of both agents are resampled independently. Where seeds did not reach the level, the
    ratio has a bound on one side only.

    Args:
        budget: Budget of the agent.
        other: Budget of the other agent, for the same level.

    Raises:
        ConfigError: Budgets for different levels.
    """
    if budget.level != other.level:
        raise ConfigError(
            f"level = {other.level:g} of other is not that of budget, {budget.level:g}"
        )
    by, other_by = (np.inf if one.by is None else one.by for one in (budget, other))
    least = float(_divide(budget.after, other_by, 0.0))
    most = float(_divide(by, other.after, np.inf))
    low = high = None
    if min(len(budget.seeds), len(other.seeds)) > 1:
        rng = np.random.default_rng(RESAMPLING_SEED)
        (afters, bys), (other_afters, other_bys) = (
            _resampled_medians(one.seeds, rng) for one in (budget, other)
        )
        lower, upper = _divide(afters, other_bys, 0.0), _divide(bys, other_afters, np.inf)
        low, high = _ends(lower, upper, least, most)
    return Ratio(
        value=by / other_by if 0 < other_by < np.inf and by < np.inf else None,
        least=least,
        most=_finite(most),
        low=low,
        high=high,
    )


def _check_level(level: float) -> float:
    checked = check_number("level", level, 0, 1, "of the cases")
    if checked == 0:
        raise ConfigError("level = 0 is reached without learning, expected a number in (0, 1]")
    return checked


def _bounds(seeds: Sequence[Crossing]) -> tuple[Floats, Floats]:
    """Lower and upper bounds of the seeds, sorted; infinite where the level was not reached."""
    after = [seed.after for seed in seeds]
    by = [np.inf if seed.by is None else seed.by for seed in seeds]
    order = np.lexsort((after, by))
    return np.array(after)[order], np.array(by)[order]


def _resampled_medians(
    seeds: Sequence[Crossing], rng: np.random.Generator
) -> tuple[Floats, Floats]:
    """Median of the lower and of the upper bounds in each resample of the seeds."""
    after, by = _bounds(seeds)
    chosen = rng.integers(len(seeds), size=(RESAMPLES, len(seeds)))
    return np.median(after[chosen], axis=1), np.median(by[chosen], axis=1)


def _ends(lower: Floats, upper: Floats, least: float, most: float) -> tuple[float, float | None]:
    """The interval's ends, which hold both bounds of the estimate.

    Nothing is interpolated, because upper bounds may be infinite.
    """
    tail = (1 - CONFIDENCE) / 2
    low = float(np.quantile(lower, tail, method="lower"))
    high = float(np.quantile(upper, 1 - tail, method="higher"))
    return min(low, least), _finite(max(high, most))


def _divide(a: Floats | float, b: Floats | float, undefined: float) -> Floats:
    """The ratios, `undefined` where they are infinite or 0/0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        quotient = np.divide(a, b)
    return np.where(np.isfinite(quotient), quotient, undefined)


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _with_interval(value: float, low: float | None, high: float | None, form: str) -> str:
    if low is None:
        return f"{value:{form}}"
    end = f"at least {low:{form}}" if high is None else f"{low:{form}}–{high:{form}}"
    return f"{value:{form}} ({end})"
