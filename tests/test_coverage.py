"""How often the intervals hold the true value, in simulated studies: the docstrings' figures."""

import re

import numpy as np
import pytest

from gym_babble.study import efficiency, statistics, two_agents
from gym_babble.study.efficiency import Curve, budget, ratio
from gym_babble.study.statistics import interval, iqm
from gym_babble.study.two_agents import improvement

pytest.importorskip("scipy")
SEEDS = (3, 5, 10, 20)
RESAMPLES = 1_000  # Fewer than a report has, for speed.


@pytest.fixture(autouse=True)
def fewer_resamples(monkeypatch):
    for module in (statistics, two_agents, efficiency):
        monkeypatch.setattr(module, "RESAMPLES", RESAMPLES)
    monkeypatch.setattr(two_agents, "PERMUTATIONS", 1)  # Of no interest here.


def documented(module, column):
    """The coverage in a column of the table in a module's docstring, for each number of seeds."""
    rows = [line.strip("| ").split("|") for line in module.__doc__.splitlines() if "|" in line]
    head = [cell.strip() for cell in rows[0]]
    cells = [row for row in rows if re.fullmatch(r"\d+ *", row[0])]
    return {int(row[0]): float(row[head.index(column)]) for row in cells}


# Scores of seeds: a normal distribution, agents near perfection, and agents that fail at times.
POPULATIONS = {
    "normal": lambda rng, shape: rng.normal(size=shape),
    "near 1": lambda rng, shape: rng.binomial(1000, rng.beta(19, 1, shape)) / 1000,
    "a fifth fails": lambda rng, shape: np.where(
        rng.random(shape) < 0.2, rng.beta(2, 8, shape), rng.beta(45, 5, shape)
    ),
}


def over_seeds(name):
    draw = POPULATIONS[name]
    truth = iqm(draw(np.random.default_rng(1), 1_000_000))

    def holds(rng, seeds):
        found = interval(draw(rng, seeds))
        return found.low <= truth <= found.high

    return holds


def outcomes(rng, seeds, cases):
    """Success of seeds with different skill on shared cases of different difficulty."""
    skill, difficulty = rng.normal(2, 1, (seeds, 1)), rng.normal(0, 2, cases)
    return rng.random((seeds, cases)) < 1 / (1 + np.exp(difficulty - skill))


def over_both():
    rng = np.random.default_rng(1)
    skill, difficulty = rng.normal(2, 1, (10_000, 1)), rng.normal(0, 2, 1_000)
    truth = iqm((1 / (1 + np.exp(difficulty - skill))).mean(axis=1))

    def holds(rng, seeds):
        found = interval(outcomes(rng, seeds, 100))
        return found.low <= truth <= found.high

    return holds


def over_pairs(rng, seeds):
    found = improvement(rng.normal(0.5, 1, seeds), rng.normal(0, 1, seeds)).probability
    return found.low <= 0.6382 <= found.high  # The normal distribution of .5/√2.


CHECKPOINTS = np.multiply.outer(10.0 ** np.arange(2, 6), (1, 2, 5)).ravel()


def budgets(rng, seeds, median):
    """Seeds that reach the level after a log-normal number of steps, tested up to 50,000."""
    needs = median * np.exp(rng.normal(0, 1, seeds))
    steps = CHECKPOINTS[CHECKPOINTS <= 50_000]
    return budget([Curve(steps, (steps >= need).astype(float)) for need in needs], 0.5)


MEDIAN = 50_000 / np.exp(0.8416)  # A fifth of the seeds needs more than 50,000.


def over_medians(rng, seeds):
    found = budgets(rng, seeds, MEDIAN)
    return found.low <= MEDIAN and (found.high is None or found.high >= MEDIAN)


def over_ratios(rng, seeds):
    found = ratio(budgets(rng, seeds, MEDIAN), budgets(rng, seeds, MEDIAN / 8))
    return found.low <= 8 and (found.high is None or found.high >= 8)


HOLDS = {
    (statistics, "normal"): lambda: over_seeds("normal"),
    (statistics, "near 1"): lambda: over_seeds("near 1"),
    (statistics, "a fifth fails"): lambda: over_seeds("a fifth fails"),
    (statistics, "seeds and cases"): over_both,
    (two_agents, "coverage"): lambda: over_pairs,
    (efficiency, "median"): lambda: over_medians,
    (efficiency, "ratio"): lambda: over_ratios,
}


def coverage(holds, seeds, studies):
    rng = np.random.default_rng([7, seeds])
    return np.mean([holds(rng, seeds) for _ in range(studies)])


def assert_documented(module, column, seeds, studies):
    expected = documented(module, column)[seeds]
    # Both figures come from simulations: the documented one from 1,000 studies.
    error = np.sqrt(expected * (1 - expected) * (1 / studies + 1 / 1_000))
    found = coverage(HOLDS[module, column](), seeds, studies)
    assert found == pytest.approx(expected, abs=4 * error + 0.01)


@pytest.mark.parametrize(("module", "column"), [(statistics, "normal"), (efficiency, "median")])
def test_the_documented_coverage_of_five_seeds(module, column):
    assert_documented(module, column, 5, 200)


@pytest.mark.slow
@pytest.mark.parametrize(("module", "column"), HOLDS)
@pytest.mark.parametrize("seeds", SEEDS)
def test_the_documented_coverage(module, column, seeds):
    assert_documented(module, column, seeds, 200)
