"""Statistics over the seeds of one agent: laws, and twins in NumPy."""

import math
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gym_babble.errors import ConfigError, MissingExtraError
from gym_babble.study import statistics
from gym_babble.study.statistics import few_seeds, interval, iqm, profile, summary

pytest.importorskip("scipy")
RATES = st.lists(st.floats(0, 1), min_size=2, max_size=12)


@pytest.fixture(autouse=True)
def fewer_resamples(monkeypatch):
    monkeypatch.setattr(statistics, "RESAMPLES", 1_000)


@pytest.fixture
def outcomes():
    """Success of 6 seeds on 40 shared cases."""
    rng = np.random.default_rng(0)
    return rng.random((6, 40)) < rng.beta(4, 1, (6, 1))


def middle_half(scores):
    """The IQM in two lines."""
    cut = len(scores) // 4
    return np.mean(np.sort(scores)[cut : len(scores) - cut])


def percentiles(resampled):
    return np.quantile(resampled, [0.025, 0.975])


@given(RATES)
def test_the_iqm_is_the_mean_of_the_middle_half(scores):
    assert iqm(scores) == pytest.approx(middle_half(scores))
    assert iqm([1, 2, 3, 4, 5, 6, 7, 8]) == 4.5


@given(RATES, st.randoms())
def test_an_interval_has_the_same_bits_in_any_order_of_the_seeds(scores, random):
    shuffled = random.sample(scores, len(scores))
    assert interval(shuffled) == interval(scores)
    assert summary(shuffled) == summary(scores)


def test_the_order_of_seeds_does_not_matter_with_shared_cases(outcomes):
    assert interval(outcomes[::-1]) == interval(outcomes)


@given(RATES)
def test_an_interval_holds_its_estimate_and_lies_among_the_scores(scores):
    found = interval(scores)
    assert found.low <= found.estimate <= found.high
    rounding = 1e-12
    assert min(scores) - rounding <= found.low
    assert found.high <= max(scores) + rounding


@given(RATES, st.floats(0, 1))
def test_better_seeds_never_lower_an_estimate_or_an_end(scores, gain):
    before, after = interval(scores), interval([score + gain for score in scores])
    for name in ("estimate", "low", "high"):
        assert getattr(after, name) >= getattr(before, name) - 1e-12


@given(RATES, st.floats(0.1, 9), st.floats(-5, 5))
def test_other_units_give_the_same_interval_in_these_units(scores, scale, shift):
    found, other = interval(scores), interval([scale * score + shift for score in scores])
    assert other.low == pytest.approx(scale * found.low + shift, abs=1e-9)
    assert other.high == pytest.approx(scale * found.high + shift, abs=1e-9)


def test_the_bootstrap_over_seeds_is_that_of_its_definition(monkeypatch):
    monkeypatch.setattr(statistics, "RESAMPLES", 10_000)
    scores = np.random.default_rng(3).random(9)
    rng = np.random.default_rng(4)
    resampled = [middle_half(rng.choice(scores, 9)) for _ in range(10_000)]
    found = interval(scores)
    assert [found.low, found.high] == pytest.approx(percentiles(resampled), abs=0.01)


def test_the_bootstrap_over_seeds_and_cases_is_that_of_its_definition(outcomes, monkeypatch):
    monkeypatch.setattr(statistics, "RESAMPLES", 10_000)
    rng = np.random.default_rng(4)

    def resample():
        seeds, cases = rng.integers(6, size=6), rng.integers(40, size=40)
        return middle_half(outcomes[np.ix_(seeds, cases)].mean(axis=1))

    found = interval(outcomes)
    assert found.estimate == pytest.approx(middle_half(outcomes.mean(axis=1)))
    expected = percentiles([resample() for _ in range(10_000)])
    assert [found.low, found.high] == pytest.approx(expected, abs=0.01)


def test_the_variance_over_seeds_and_cases_is_owens(outcomes):
    # Owen (2007), "The pigeonhole bootstrap": the moments of two independent multinomial weights
    # give the variance of the resampled mean in closed form.
    x = outcomes - outcomes.mean()
    r, c = x.shape
    rows, columns, each = (
        np.sum(x.sum(axis=1) ** 2),
        np.sum(x.sum(axis=0) ** 2),
        np.sum(x**2),
    )
    variance = ((1 - 1 / c) * rows + (1 - 1 / r) * columns + each) / (r * c) ** 2
    resampled = statistics._resample_both(outcomes.astype(float), np.mean)
    error = math.sqrt(2 / statistics.RESAMPLES)
    assert np.var(resampled) == pytest.approx(variance, rel=4 * error)


def test_without_differences_between_cases_only_seeds_count():
    # Each seed solves all cases or none, so the cases can't matter.
    solved = np.array([1, 1, 0, 1, 1, 1, 0, 1], dtype=bool)
    found, both = interval(solved), interval(np.repeat(solved[:, None], 50, axis=1))
    assert (both.estimate, both.low, both.high) == (found.estimate, found.low, found.high)


def test_a_summary_has_the_worst_seed_beside_the_interval():
    found = summary([0.9, 0.1, 0.95, 0.92, 0.94])
    assert (found.seeds, found.worst, found.best, found.median) == (5, 0.1, 0.95, 0.92)
    assert found.mean == pytest.approx(0.762)
    assert found.iqm == interval([0.9, 0.1, 0.95, 0.92, 0.94])


def test_one_seed_has_no_interval_and_few_seeds_a_warning():
    alone = interval([0.7])
    assert (alone.estimate, alone.low, alone.high) == (0.7, None, None)
    assert interval([[True, False]]).low is None
    assert "Only 1 seed:" in few_seeds(1)
    assert "Only 4 seeds" in few_seeds(4)
    assert few_seeds(5) is None


@given(RATES, st.lists(st.floats(0, 1), min_size=1, max_size=5))
def test_a_profile_is_the_share_of_seeds_above_with_its_band(scores, thresholds):
    found = profile(scores, thresholds)
    assert found.shares == pytest.approx([np.mean(np.array(scores) > t) for t in thresholds])
    for low, share, high in zip(found.low, found.shares, found.high, strict=True):
        assert 0 <= low <= share <= high <= 1


def test_a_profile_averages_cases(outcomes):
    thresholds = [0.5, 0.8]
    assert profile(outcomes, thresholds) == profile(outcomes.mean(axis=1), thresholds)


@pytest.mark.parametrize(
    ("scores", "named"),
    [
        ([], "scores has shape (0,)"),
        (0.5, "scores has shape ()"),
        (np.zeros((2, 0)), "scores has shape (2, 0)"),
        (np.zeros((2, 2, 2)), "scores has shape (2, 2, 2)"),
        ([0.1, math.nan], "scores[1] = nan is not finite"),
        (["a"], "is not made of real numbers"),
    ],
)
def test_bad_scores_are_named(scores, named):
    for function in (interval, summary, lambda scores: profile(scores, [0.5])):
        with pytest.raises(ConfigError) as error:
            function(scores)
        assert named in str(error.value)
    with pytest.raises(ConfigError, match=r"thresholds has shape \(1, 1\)"):
        profile([1, 2], [[0.5]])


def test_without_scipy_the_error_says_what_to_install():
    program = """
import sys
sys.modules["scipy"] = None
from gym_babble.errors import MissingExtraError
from gym_babble.study.statistics import interval
try:
    interval([1, 2])
except MissingExtraError as error:
    print(error)
"""
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == str(MissingExtraError("scipy", "study"))
