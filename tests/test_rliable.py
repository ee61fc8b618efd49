"""rliable (Agarwal et al. 2021) computes the same, apart from the noise of resampling."""

import numpy as np
import pytest

from gym_babble.study.statistics import interval, profile
from gym_babble.study.two_agents import improvement

REASON = "arch, which rliable needs, has no wheels for this Python"
library = pytest.importorskip("rliable.library", reason=REASON)
metrics = pytest.importorskip("rliable.metrics", reason=REASON)
RESAMPLES = 2_000


@pytest.fixture(autouse=True)
def resampling():
    np.random.seed(0)  # noqa: NPY002 - what rliable draws from


@pytest.mark.parametrize("seeds", [3, 5, 10])
def test_iqm_and_interval(seeds):
    scores = np.random.default_rng(seeds).beta(8, 2, seeds)
    points, ends = library.get_interval_estimates(
        {"agent": scores[:, None]},
        lambda these: np.array([metrics.aggregate_iqm(these)]),
        reps=RESAMPLES,
    )
    found = interval(scores)
    assert found.estimate == pytest.approx(points["agent"].item())
    assert [found.low, found.high] == pytest.approx(ends["agent"].ravel(), abs=0.02)


def test_profile():
    scores = np.random.default_rng(1).beta(8, 2, 10)
    thresholds = np.linspace(0.05, 0.95, 7)
    shares, bands = library.create_performance_profile(
        {"agent": scores[:, None]}, thresholds, reps=RESAMPLES
    )
    found = profile(scores, thresholds)
    assert found.shares == pytest.approx(shares["agent"])
    # A share of 10 seeds is a multiple of .1: noise may move a quantile to the next one.
    for ours, theirs in zip((found.low, found.high), bands["agent"], strict=True):
        assert ours == pytest.approx(theirs, abs=0.101)
        assert np.mean(ours) == pytest.approx(np.mean(theirs), abs=0.03)


def test_probability_of_improvement():
    rng = np.random.default_rng(2)
    x, y = rng.beta(8, 2, 10).round(2), rng.beta(7, 2, 8).round(2)
    points, ends = library.get_interval_estimates(
        {"pair": [x[:, None], y[:, None]]},
        lambda *both: np.array([metrics.probability_of_improvement(*both)]),
        reps=RESAMPLES,
    )
    found = improvement(x, y).probability
    assert found.estimate == pytest.approx(points["pair"].item())
    assert [found.low, found.high] == pytest.approx(ends["pair"].ravel(), abs=0.03)
