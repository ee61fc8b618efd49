"""Measures of a reach: closed forms, and SciPy's peaks as an oracle."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.signal import find_peaks

from gym_babble.envs import BabbleGraspEnv
from gym_babble.errors import ConfigError
from gym_babble.study import movements

STEP_S = 0.05


def minimum_jerk(start, end, seconds):
    """Places of a minimum-jerk movement (Flash & Hogan 1985), without the first."""
    share = np.arange(1, round(seconds / STEP_S) + 1)[:, None] * STEP_S / seconds
    along = 10 * share**3 - 15 * share**4 + 6 * share**5
    return np.array(start) + along * (np.array(end) - np.array(start))


def through(*corners, seconds=1.0):
    """Minimum-jerk movements from corner to corner, with a stop at each."""
    parts = [minimum_jerk(a, b, seconds) for a, b in pairwise(corners)]
    return np.vstack([[corners[0]], *parts])


def test_a_minimum_jerk_movement_has_one_unit_and_is_straight():
    path = through((0.1, 0.2), (0.3, 0.1))
    assert movements.movement_units(path, STEP_S) == 1
    assert movements.straightness(path) == pytest.approx(1.0)
    # Its highest speed is 15/8 of the mean one.
    distance = np.hypot(0.2, 0.1)
    assert movements.speeds(path, STEP_S).max() == pytest.approx(1.875 * distance, rel=0.01)
    assert movements.speeds(path, STEP_S).sum() * STEP_S == pytest.approx(distance)


@pytest.mark.parametrize("n", range(1, 6))
def test_each_movement_of_several_is_a_unit(n):
    corners = [(0.1 * (k % 2), 0.1 * k) for k in range(n + 1)]
    path = through(*corners)
    assert movements.movement_units(path, STEP_S) == n
    length = n * np.hypot(0.1, 0.1)
    assert movements.straightness(path) == pytest.approx(length / np.hypot(*corners[-1]))


def test_a_circle_is_as_long_as_it_is():
    angle = np.linspace(0, np.pi, 200)
    half = np.stack([np.cos(angle), np.sin(angle)], 1)
    assert movements.straightness(half) == pytest.approx(np.pi / 2, rel=1e-4)
    assert np.isnan(movements.straightness(np.vstack([half, half[0]])))


def test_a_reach_that_a_touch_ends_has_its_last_unit():
    path = through((0, 0), (0.2, 0))
    assert movements.movement_units(path[:10], STEP_S) == 1
    assert movements.movement_units(np.zeros((5, 2)), STEP_S) == 0
    # A tremor that is slower than a unit's least rise is none.
    tremor = 0.0002 * (np.arange(40) % 2)
    assert movements.movement_units(np.stack([tremor, 0 * tremor], 1), STEP_S) == 0


@given(arrays.arrays(np.int64, st.integers(1, 40), elements=st.integers(0, 12)))
def test_units_are_the_peaks_that_scipy_finds(steps):
    # Catches a peak counted twice, and one at the start or the end that is forgotten.
    # No two speeds are equal, and all are exact in binary: SciPy takes two equal peaks as one hill.
    distinct = (64 * steps + np.arange(len(steps))) / 2**20
    along = np.concatenate([[0.0], np.cumsum(distinct)])
    path = np.stack([along, np.zeros_like(along)], 1)
    peaks, _ = find_peaks(np.concatenate([[0.0], distinct, [0.0]]), prominence=200 / 2**20)
    assert movements.movement_units(path, 1.0, rise_m_s=200 / 2**20) == len(peaks)


def test_an_episodes_trajectory_is_a_path():
    env = BabbleGraspEnv(record=True, control="posture")
    env.reset(seed=0)
    for _ in range(40):
        env.step(np.array([0.5, 0.0, -1.0, -1.0], np.float32))
    path = env.trajectory
    assert movements.movement_units(path, STEP_S) >= 1
    assert 1.0 <= movements.straightness(path) < 3.0


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: movements.straightness([[0, 0]]), r"path has shape \(1, 2\), expected \(k, 2\)"),
        (lambda: movements.speeds([[0, 0, 0]] * 3, 1), r"path has shape \(3, 3\)"),
        (lambda: movements.speeds([[0, 0]] * 3, 0), r"step_s = 0 is not a number in"),
        (lambda: movements.speeds([[0, np.nan]] * 3, 1), "path"),
        (lambda: movements.movement_units([[0, 0]] * 3, 1, rise_m_s=0), "rise_m_s = 0 is not"),
    ],
)
def test_what_is_no_path_is_refused(call, says):
    with pytest.raises(ConfigError, match=says):
        call()
