"""Budgets that agents need, with seeds that did not reach a level within theirs."""

import json
from dataclasses import asdict

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gym_babble.errors import ConfigError
from gym_babble.study import efficiency
from gym_babble.study.efficiency import Crossing, Curve, budget, crossing, ratio

CHECKPOINTS = (100, 200, 500, 1_000, 2_000, 5_000)
NEEDS = st.lists(st.sampled_from([*CHECKPOINTS, None]), min_size=2, max_size=9)


@pytest.fixture(autouse=True)
def fewer_resamples(monkeypatch):
    monkeypatch.setattr(efficiency, "RESAMPLES", 1_000)


def curves(*needs):
    """A curve for each seed: success 1 from a checkpoint on, or never (None)."""
    return [
        Curve(CHECKPOINTS, [need is not None and step >= need for step in CHECKPOINTS] * np.ones(6))
        for need in needs
    ]


def test_a_crossing_lies_between_two_checkpoints():
    curve = Curve([100, 200, 500, 1_000], [0.2, 0.6, 0.55, 0.9])
    assert crossing(curve, 0.1) == Crossing(0, 100)
    assert crossing(curve, 0.6) == Crossing(100, 200)  # Falling below it later does not count.
    assert crossing(curve, 0.61) == Crossing(500, 1_000)
    assert crossing(curve, 0.95) == Crossing(1_000, None)
    assert crossing(Curve([1], [134 / 200]), 0.67) == Crossing(0, 1)


def test_the_budget_of_several_seeds():
    found = budget(curves(100, 200, 500, 1_000, None), 0.9)
    assert found.seeds[-1] == Crossing(5_000, None)
    assert (found.reached, found.after, found.by) == (4, 200, 500)
    # Of 5 seeds, resamples may have 3 that fail: no upper end.
    assert (found.low, found.high) == (0, None)
    assert str(found) == "500 (at least 0)"
    found = budget(curves(*[500] * 5), 0.9)
    assert (found.low, found.high) == (200, 500)
    assert str(found) == "500 (200–500)"


def test_a_level_that_was_not_reached_has_no_number():
    found = budget(curves(200, None, None, None, None), 0.9)
    assert (found.reached, found.after, found.by, found.high) == (1, 5_000, None, None)
    assert str(found) == "more than 5,000"


def test_one_seed_has_bounds_but_no_interval():
    found = budget(curves(500), 0.9)
    assert (found.after, found.by, found.low, found.high) == (200, 500, None, None)
    assert str(found) == "500"
    against = ratio(found, budget(curves(5_000), 0.9))
    assert (against.value, against.least, against.most) == (0.1, 0.04, 0.25)
    assert (against.low, against.high) == (None, None)
    assert str(against) == "0.1"


def test_ratios_with_seeds_that_did_not_get_there():
    slow, fast, failed = (
        budget(curves(*needs), 0.9) for needs in ([5_000] * 5, [200] * 5, [None] * 5)
    )
    found = ratio(slow, fast)
    assert (found.value, found.low, found.high) == (25, 10, 50)
    assert str(found) == "25 (10–50)"
    assert str(ratio(failed, fast)) == "at least 25"
    assert str(ratio(fast, failed)) == "at most 0.04"
    assert str(ratio(failed, failed)) == "unknown"
    alone = budget(curves(None), 0.9)
    assert str(ratio(alone, fast)) == "at least 25"


def test_an_agent_that_needs_no_learning_has_no_ratio():
    born = budget([Curve([0, 100], [1, 1])] * 2, 0.9)
    assert (born.by, born.high) == (0, 0)
    found = ratio(budget(curves(200, 200), 0.9), born)
    assert (found.value, found.low, found.high) == (None, 0, None)
    assert str(found) == "unknown"


@given(NEEDS, st.randoms())
def test_the_order_of_seeds_does_not_matter(needs, random):
    found, shuffled = (
        budget(curves(*order), 0.9) for order in (needs, random.sample(needs, len(needs)))
    )
    for name in ("after", "by", "low", "high", "reached"):
        assert getattr(found, name) == getattr(shuffled, name)


@given(NEEDS, NEEDS)
def test_intervals_hold_what_fits_the_checkpoints(needs, others):
    one, other = budget(curves(*needs), 0.9), budget(curves(*others), 0.9)
    assert one.low <= one.after
    assert one.high is None or (one.by is not None and one.after < one.by <= one.high)
    found = ratio(one, other)
    assert found.low <= found.least
    assert found.high is None or found.least <= found.most <= found.high
    json.dumps([asdict(one), asdict(found)], allow_nan=False)
    if found.value is not None:
        assert found.least <= found.value
        assert found.most is None or found.value <= found.most


@given(NEEDS, st.floats(0.1, 1))
def test_a_higher_level_never_needs_less(needs, level):
    rising = [
        Curve(CHECKPOINTS, np.linspace(0, 1, 6) ** (1 + (need or 9_999) / 100)) for need in needs
    ]
    low, high = budget(rising, level / 2), budget(rising, level)
    assert low.after <= high.after
    assert high.by is None or low.by <= high.by


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: Curve([], []), "shape (0,)"),
        (lambda: Curve([1, 2], [0.5]), "control_steps has shape (2,) and success (1,)"),
        (lambda: Curve([-1], [0.5]), "control_steps[0] = "),
        (lambda: Curve([1, 3, 3], [0, 0, 0]), "control_steps[2] = 3 is not greater than"),
        (lambda: Curve([1, 2], [0, 1.5]), "success[1] = 1.5 is not a rate in [0, 1]"),
        (lambda: Curve([1, 2], [0, np.nan]), "success[1] = nan is not finite"),
        (lambda: budget([], 0.9), "curves is empty"),
        (lambda: budget(curves(100), 1.5), "level = 1.5"),
        (lambda: budget(curves(100), 0), "level = 0 is reached without learning"),
        (
            lambda: ratio(budget(curves(100), 0.9), budget(curves(100), 0.8)),
            "level = 0.8 of other is not that of budget, 0.9",
        ),
    ],
)
def test_bad_input_is_named(call, named):
    with pytest.raises(ConfigError) as error:
        call()
    assert named in str(error.value)
