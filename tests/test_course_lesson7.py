"""Lesson 7: right answers are right, and the usual wrong ones have their own message."""

from __future__ import annotations

import json

import numpy as np
import pytest
from conftest import ROOT

from gym_babble import course
from gym_babble.course.lesson7 import CLAIMS, _scores
from gym_babble.course.published import FILE, published
from gym_babble.errors import ConfigError
from gym_babble.study.outcomes import wilson
from results.course import numbers


def test_the_published_numbers_are_those_of_the_study():
    found = numbers(ROOT / "results" / "published")
    assert json.loads(FILE.read_text(encoding="utf-8")) == found


def test_steps_to_a_success_are_those_of_the_first_checkpoint_that_has_it():
    agent = published("reach")["hebb-conjunctive"]
    for run in agent.runs:
        steps = run.steps_to(0.9)
        before, after = run.control_steps < steps, run.control_steps == steps
        assert (run.curve[before] < 0.9).all()
        assert run.curve[after] >= 0.9
    assert np.isinf(agent.steps_to(1.01)).all()


def test_an_unknown_task_is_an_error():
    with pytest.raises(ConfigError, match="'walk'"):
        published("walk")


def clipped(ratio, advantage, epsilon):
    return np.minimum(ratio * advantage, np.clip(ratio, 1 - epsilon, 1 + epsilon) * advantage)


def by_cases(ratio, advantage, epsilon):
    if advantage > 0:
        return min(ratio, 1 + epsilon) * advantage
    return max(ratio, 1 - epsilon) * advantage


@pytest.mark.parametrize("objective", [clipped, by_cases])
def test_ppos_objective_is_right_however_it_is_written(objective):
    assert course.check("7.1", objective).right


@pytest.mark.parametrize(
    ("objective", "said"),
    [
        (lambda r, a, _e: r * a, "clip is missing"),
        (lambda r, a, e: np.clip(r, 1 - e, 1 + e) * a, "minimum is missing"),
        (lambda r, a, e: max(r * a, np.clip(r, 1 - e, 1 + e) * a), "greater of the two"),
        (lambda r, a, e: -clipped(r, a, e), "sign is that of a loss"),
        (lambda r, a, e: min(r, np.clip(r, 1 - e, 1 + e)) * a, "before the product"),
        (lambda r, a, e: clipped(r, a, e) + 0.1, "off by"),
    ],
)
def test_usual_wrong_objectives_are_named(objective, said):
    assert said in repr(course.check("7.1", objective))


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (224 * 10_916, ""),
        (np.int64(2_445_184), ""),
        (224 * 2_000, "Only legal movements"),
        (10_916, "number of movements"),
        (2_000, "number of legal movements"),
        (2_445_184 * 0.05, "seconds"),
        (1e6, "It is not 1,000,000"),
    ],
)
def test_all_movements_count(answer, said):
    result = course.check("7.2", answer)
    assert result.right == (said == "")
    assert said in repr(result)


FAIR = [fair for fair, _ in CLAIMS]


def test_fair_conclusions_are_those_that_differ_in_one_thing():
    assert course.check("7.3", FAIR).right
    assert course.check("7.3", np.array(FAIR)).right
    assert "other way round" in repr(course.check("7.3", [1 - fair for fair in FAIR]))
    assert "0 or 1" in repr(course.check("7.3", [0.5] * 7))
    assert "Shape (7,)" in repr(course.check("7.3", FAIR[:6]))
    assert "same input?" in repr(course.check("7.3", [0] * 7))


@pytest.mark.parametrize("number", range(7))
def test_one_conclusion_that_is_misjudged_is_explained(number):
    answer = [1 - fair if k == number else fair for k, fair in enumerate(FAIR)]
    result = course.check("7.3", answer)
    assert f"Look at number {number + 1}." in result.text
    assert result.hint == CLAIMS[number][1]


def bootstrapped(seed, n=10_000):
    scores = _scores()
    means = np.random.default_rng(seed).choice(scores, (n, len(scores))).mean(axis=1)
    return np.quantile(means, [0.025, 0.975])


def test_a_bootstrap_interval_is_right_with_any_seed_and_as_scipys():
    stats = pytest.importorskip("scipy.stats")
    for seed in range(5):
        assert course.check("7.4", bootstrapped(seed)).right
        assert course.check("7.4", tuple(bootstrapped(seed, 2_000))).right
    found = stats.bootstrap((_scores(),), np.mean, method="percentile").confidence_interval
    assert course.check("7.4", found).right


def test_usual_wrong_intervals_are_named():
    scores = _scores()
    mean, deviation = scores.mean(), scores.std(ddof=1)
    half = 1.96 * deviation / np.sqrt(5)
    for interval, said in (
        (bootstrapped(0)[::-1], "exchanged"),
        (wilson(round(5_000 * mean), 5_000), "interval over cases"),
        ((mean - half, mean + half), "normally distributed"),
        (np.quantile(scores, [0.025, 0.975]), "where seeds lie"),
        ((0.1, 0.2), "The interval is not 0.100"),
        (mean, "Shape (2,)"),
    ):
        result = course.check("7.4", interval)
        assert not result.right
        assert said in repr(result)


def test_the_ratio_is_that_of_the_median_seeds():
    steps = {name: agent.steps_to(0.9) for name, agent in published("reach").items()}
    ppo, hebb = steps["ppo-eye-obstacle"], steps["hebb-conjunctive"]
    ratio = np.median(ppo) / np.median(hebb)
    for answer, said in (
        (ratio, ""),
        (round(ratio, 1), ""),
        (1 / ratio, "Hebb over PPO"),
        (np.median(ppo) - np.median(hebb), "difference"),
        (np.mean(ppo) / np.mean(hebb), "means"),
        (np.median(steps["sac"]) / np.median(hebb), "SAC"),
        (2, "It is not 2"),
    ):
        result = course.check("7.5", answer)
        assert result.right == (said == "")
        assert said in repr(result)
