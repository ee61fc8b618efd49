"""Random play for long: tests/soak.py says what is looked at."""

from __future__ import annotations

import pytest
from soak import soak


@pytest.mark.parametrize(
    ("task", "steps", "outcomes"),
    [
        ("reach", 100_000, {"success", "collision", "joint_limit", "timeout"}),
        ("grasp", 30_000, {"collision", "timeout"}),
    ],
)
def test_a_short_soak(task, steps, outcomes):
    tally = soak(task, steps, rounds=2, num_envs=16)
    assert tally.steps >= steps
    assert tally.refused >= 100
    assert tally.resets >= 100
    assert set(tally.outcomes) >= outcomes


@pytest.mark.soak
@pytest.mark.parametrize("task", ["reach", "grasp"])
def test_a_long_soak(task):
    tally = soak(task, 10_000_000, show=True)
    print(tally)
    assert tally.steps >= 10_000_000
