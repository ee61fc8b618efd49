"""Table I's difference from the paper."""

import numpy as np
import pytest

from gym_babble import Evaluation
from gym_babble.paper.table1 import TableOne
from gym_babble.study.rates import OUTCOMES


def test_z_is_the_difference_from_the_paper_over_its_standard_error():
    """Compared with the spread of two simulated rates of independent cases."""
    draws = np.random.default_rng(0)
    tests = tuple(evaluation(n) for n in draws.binomial(1_000, 0.731, 5))
    found = TableOne({}, tuple(range(5)), tests, (0.2,) * 5).to_json()
    ours = found["over_seeds"]["success"]["mean"]
    simulated = draws.binomial(5_000, ours, 200_000) / 5_000
    simulated -= draws.binomial(1_000, 0.67, 200_000) / 1_000
    z = (ours - 0.67) / simulated.std()
    assert found["z_from_paper"]["success"] == pytest.approx(z, rel=0.01)
    assert found["z_from_paper"]["collision"] < 0
    assert found["z_from_paper"]["timeout"] is None  # Neither has one.


def evaluation(successes):
    """1,000 cases, of which the others collide half the time."""
    limits = (1_000 - successes) // 2
    outcomes = ["success"] * successes + ["joint_limit"] * limits
    outcomes += ["collision"] * (1_000 - len(outcomes))
    cases, steps, returns = ({},) * 1_000, (1,) * 1_000, (0.0,) * 1_000
    return Evaluation(cases, tuple(outcomes), steps, returns, possible=OUTCOMES)
