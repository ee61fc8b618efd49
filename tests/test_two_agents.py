"""Comparisons of two agents: laws, and the examples of textbooks."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gym_babble.errors import ConfigError
from gym_babble.study import two_agents
from gym_babble.study.two_agents import improvement, mcnemar

stats = pytest.importorskip("scipy.stats")
# Few different scores, so that there are ties.
SCORES = st.lists(st.sampled_from([0.1, 0.3, 0.5, 0.7, 0.9]), min_size=2, max_size=5)
OUTCOMES = st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=40)


@pytest.fixture(autouse=True)
def fewer_resamples(monkeypatch):
    monkeypatch.setattr(two_agents, "RESAMPLES", 2_000)


def pairs_won(x, y):
    """The probability of improvement in one line."""
    return np.mean([(a > b) + (a == b) / 2 for a in x for b in y])


@given(SCORES, SCORES)
def test_the_probability_is_the_share_of_pairs_and_the_u_of_mann_and_whitney(x, y):
    found = improvement(x, y).probability
    assert found.estimate == pytest.approx(pairs_won(x, y))
    u = stats.mannwhitneyu(x, y, method="asymptotic").statistic if len({*x, *y}) > 1 else None
    assert u is None or found.estimate == pytest.approx(u / (len(x) * len(y)))
    assert found.low <= found.estimate <= found.high


@given(SCORES, SCORES)
def test_either_agent_wins_or_they_tie(x, y):
    there, back = improvement(x, y), improvement(y, x)
    assert there.probability.estimate + back.probability.estimate == pytest.approx(1)
    assert there.p_value == pytest.approx(back.p_value)


@given(SCORES, SCORES, st.randoms())
def test_the_order_of_seeds_does_not_matter(x, y, random):
    assert improvement(random.sample(x, len(x)), y) == improvement(x, y)


@given(SCORES, SCORES)
def test_better_seeds_never_win_less(x, y):
    better = [score + 0.2 for score in x]
    assert improvement(better, y).probability.estimate >= improvement(x, y).probability.estimate


def test_the_tortoises_and_the_hares():
    # One tortoise beats six hares, five tortoises beat one: U = 11 of 36 pairs.
    order = "THHHHHTTTTTH"
    rank = {animal: [-k for k, a in enumerate(order) if a == animal] for animal in "TH"}
    assert improvement(rank["T"], rank["H"]).probability.estimate == pytest.approx(11 / 36)


def test_the_p_value_is_exact_for_few_seeds():
    # All seeds of one above all of the other: two of the C(2n, n) rearrangements are as extreme.
    for n, p in ((3, 2 / 20), (5, 2 / 252)):
        found = improvement(range(n), range(n, 2 * n))
        assert found.probability.estimate == found.probability.high == 0
        assert found.p_value == pytest.approx(p)
    # Ties count, too: 6 of 10 rearrangements of 0 0 | 0 1 1 have as extreme rank sums.
    assert improvement([0, 0], [0, 1, 1]).p_value == pytest.approx(0.6)
    assert improvement([1, 1, 1], [1, 1]).p_value == 1


def test_ties_change_the_way_but_not_the_p_value():
    # 20,000 random rearrangements of 10 against 10, because of a tie that decides nothing.
    x, y = np.arange(0, 20, 2.0), np.arange(5, 25, 2.0)
    tied = np.where(y == 23, 21, y)
    p = improvement(x, y).p_value
    assert improvement(x, tied).p_value == pytest.approx(p, abs=4 * np.sqrt(p * (1 - p) / 20_000))


def test_cases_are_averaged_and_one_seed_has_no_interval():
    outcomes = np.random.default_rng(0).random((4, 30)) < 0.6
    assert improvement(outcomes, [0.5, 0.6]) == improvement(outcomes.mean(axis=1), [0.5, 0.6])
    alone = improvement([1], [2, 3])
    assert (alone.probability.estimate, alone.probability.low, alone.p_value) == (0, None, None)


@given(OUTCOMES)
def test_mcnemar_counts_each_case_once_and_is_symmetric(outcomes):
    first, second = np.array(outcomes).T
    there, back = mcnemar(first, second), mcnemar(second, first)
    assert there.both + there.only_first + there.only_second + there.neither == len(outcomes)
    assert (there.only_first, there.only_second) == (back.only_second, back.only_first)
    assert there.p_value == pytest.approx(back.p_value)
    assert 0 < there.p_value <= 1


def test_mcnemars_exact_p_value():
    # 6 and 16 cases that only one agent solves: .053 by the exact binomial test (Wikipedia).
    first = np.repeat([1, 1, 0, 0], [59, 6, 16, 80])
    second = np.repeat([1, 0, 1, 0], [59, 6, 16, 80])
    found = mcnemar(first, second)
    assert (found.both, found.only_first, found.only_second, found.neither) == (59, 6, 16, 80)
    assert found.p_value == pytest.approx(0.053, abs=0.0006)
    assert mcnemar([True, False], [True, False]).p_value == 1


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: mcnemar([1, 0], [1]), "first has 2 cases and second 1"),
        (lambda: mcnemar([[1]], [1]), "first has shape (1, 1)"),
        (lambda: mcnemar([], []), "first has shape (0,)"),
        (lambda: mcnemar([1], [0.5]), "second has 0.5"),
        (lambda: improvement([], [1]), "x has shape (0,)"),
        (lambda: improvement([1], [np.inf]), "y[0] = inf is not finite"),
    ],
)
def test_bad_input_is_named(call, named):
    with pytest.raises(ConfigError) as error:
        call()
    assert named in str(error.value)
